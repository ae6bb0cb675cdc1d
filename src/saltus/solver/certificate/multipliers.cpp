#include "saltus/solver/certificate/multipliers.hpp"

#include <algorithm>
#include <cmath>

#include "saltus/base/at.hpp"

namespace saltus::solver::certificate {
namespace {

using crossover::Hold;
using mpcc::ActiveSide;
using mpcc::Sign;

MpccMultipliers with_sides(mpcc::Problem& problem, const RowMatrix& jacobian, const linalg::Vector& y,
                           linalg::Vector pressure, const PairStates& states) {
  const int n_g = problem.constraints();
  const int pairs = problem.pairs();
  MpccMultipliers result{
      .rows = y.head(n_g), .lower = {}, .upper = {}, .G = -y.segment(n_g, pairs), .H = -y.tail(pairs)};
  const auto take = [&](int pair, ActiveSide which) {
    const int side = which == ActiveSide::G ? pair : pairs + pair;
    if (problem.signs()[at(side)] != Sign::implied) return;
    take_from_bounds(jacobian, n_g + side, pressure, (which == ActiveSide::G ? result.G : result.H)[pair]);
  };
  for (const bool open : {false, true}) {
    for (int pair = 0; pair < pairs; ++pair) {
      if (problem.pair_group(pair) < 0 || states.is_open[at(pair)] != open) continue;
      take(pair, states.sides[at(pair)]);
    }
  }
  for (int pair = 0; pair < pairs; ++pair) {
    if (problem.pair_group(pair) < 0 || !states.biactive[at(pair)]) continue;
    take(pair, states.sides[at(pair)] == ActiveSide::G ? ActiveSide::H : ActiveSide::G);
  }
  result.lower = pressure.at_least(0.0);
  result.upper = (-pressure).at_least(0.0);
  return result;
}

linalg::Vector slope_of(mpcc::Problem& problem, ConstVectorView w, const RowMatrix& jacobian, const linalg::Vector& y) {
  linalg::Vector slope(problem.variables());
  problem.objective_gradient(w, slope);
  return slope + jacobian.transposed_times(y);
}

}  // namespace

MpccMultipliers multipliers_of_branch(mpcc::Problem& problem, const crossover::BranchProblem& branch,
                                      const NlpPoint& point, const PairStates& states) {
  const auto& reduction = branch.reduction();
  const auto& bounds = problem.variable_bounds();
  const linalg::Vector w = branch.full(point.w);
  const RowMatrix jacobian = jacobian_matrix(problem, w);
  linalg::Vector y = linalg::Vector::zero(problem.rows());
  for (std::size_t row = 0; row < reduction.rows.size(); ++row) y[reduction.rows[row]] = point.y[index(row)];
  linalg::Vector pressure = slope_of(problem, w, jacobian, y);
  for (linalg::Index i = 0; i < w.size(); ++i) {
    const int place = reduction.place[at(i)];
    if (place >= 0) {
      const bool leads = reduction.leader[at(place)] == i;
      pressure[i] = leads ? point.z_lower[place] - point.z_upper[place] : 0.0;
    } else if (reduction.hold[at(i)] == Hold::closure) {
      // What presses away from the bound is borne by the closure.
      if (w[i] != bounds.lower[i]) pressure[i] = std::min(pressure[i], 0.0);
      if (w[i] != bounds.upper[i]) pressure[i] = std::max(pressure[i], 0.0);
    }
  }
  return with_sides(problem, jacobian, y, pressure, states);
}

MpccMultipliers multipliers_of_relaxed(mpcc::Problem& problem, homotopy::RelaxedProblem& relaxed, const NlpPoint& point,
                                       const PairStates& states) {
  const int n = problem.variables();
  const linalg::Vector y = relaxed.multipliers_of_problem(point.w, point.y);
  const linalg::Vector pressure = point.z_lower.head(n) - point.z_upper.head(n);
  return with_sides(problem, jacobian_matrix(problem, point.w.head(n)), y, pressure, states);
}

double stationarity(mpcc::Problem& problem, ConstVectorView w, const MpccMultipliers& multipliers,
                    const crossover::Reduction* reduction) {
  const linalg::Vector y = linalg::joined({multipliers.rows, -multipliers.G, -multipliers.H});
  linalg::Vector slope = slope_of(problem, w, jacobian_matrix(problem, w), y) - multipliers.lower + multipliers.upper;
  if (reduction != nullptr) {
    linalg::Vector summed = linalg::Vector::zero(reduction->variables());
    for (linalg::Index i = 0; i < slope.size(); ++i) {
      if (reduction->place[at(i)] >= 0) summed[reduction->place[at(i)]] += slope[i];
      if (reduction->place[at(i)] >= 0 || reduction->hold[at(i)] == Hold::closure) slope[i] = 0.0;
    }
    const double of_held = slope.max_abs();
    slope = linalg::joined({summed, linalg::ConstView(&of_held, 1)});
  }
  const double total = y.sum_abs() + multipliers.lower.sum_abs() + multipliers.upper.sum_abs();
  const double mean = total / static_cast<double>(std::max<linalg::Index>(1, y.size() + 2 * w.size()));
  return slope.max_abs() / std::max(1.0, mean);
}

}  // namespace saltus::solver::certificate
