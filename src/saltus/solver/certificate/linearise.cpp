#include "saltus/solver/certificate/linearise.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "saltus/base/at.hpp"
#include "saltus/solver/crossover/sides.hpp"

namespace saltus::solver::certificate {
namespace {

using crossover::Hold;
using mpcc::ActiveSide;
using mpcc::Sign;

constexpr double unlimited = std::numeric_limits<double>::infinity();

/// Collects rows of A d; variables that cannot move have no entries.
class Rows {
 public:
  Rows(const RowMatrix& jacobian, const std::vector<bool>& is_held, double radius)
      : jacobian_(jacobian), is_held_(is_held), radius_(radius) {}

  /// lower <= c + row d <= upper; left out if no d within the radius can violate it.
  void add(int row, double c, double lower, double upper) {
    double reach = 0.0;
    for (const linalg::Entry entry : jacobian_.along(row)) {
      if (!is_held_[at(entry.inner)]) reach += std::abs(entry.value);
    }
    // The point itself is feasible: what rounding says against that is none of the directions'.
    const double down = std::min((lower - c) / radius_, 0.0);
    const double up = std::max((upper - c) / radius_, 0.0);
    if (reach == 0.0 || (down < -reach && up > reach)) return;
    const int own = begin(lower == upper ? 0.0 : down, lower == upper ? 0.0 : up);
    add_entries(own, row);
  }
  /// sum of rows >= 0; its number.
  int add_sum(const std::vector<int>& rows) {
    const int own = begin(0.0, unlimited);
    for (const int row : rows) add_entries(own, row);
    return own;
  }
  void add_equality(int i, int j) {
    const int own = begin(0.0, 0.0);
    pattern_.add(own, i);
    entries_.push_back(1.0);
    pattern_.add(own, j);
    entries_.push_back(-1.0);
  }
  void finish(LpccProblem& problem) const {
    problem.pattern = pattern_;
    problem.entries = linalg::ConstView(entries_);
    problem.rows.lower = linalg::ConstView(lower_);
    problem.rows.upper = linalg::ConstView(upper_);
  }

 private:
  int begin(double lower, double upper) {
    lower_.push_back(lower);
    upper_.push_back(upper);
    return static_cast<int>(lower_.size()) - 1;
  }
  void add_entries(int own, int row) {
    for (const linalg::Entry entry : jacobian_.along(row)) {
      if (is_held_[at(entry.inner)] || entry.value == 0.0) continue;
      pattern_.add(own, entry.inner);
      entries_.push_back(entry.value);
    }
  }

  const RowMatrix& jacobian_;
  const std::vector<bool>& is_held_;
  double radius_;
  mpcc::Pattern pattern_;
  std::vector<double> entries_, lower_, upper_;
};

/// Variables that no direction moves: bounds, closure, implied zero sides of pairs without a choice.
std::vector<bool> find_held(mpcc::Problem& problem, const RowMatrix& jacobian, const PairStates& states,
                            const crossover::Reduction* reduction) {
  const auto& bounds = problem.variable_bounds();
  std::vector<bool> is_held(at(problem.variables()), false);
  for (int i = 0; i < problem.variables(); ++i) {
    const bool by_closure = reduction != nullptr && reduction->hold[at(i)] == Hold::closure;
    is_held[at(i)] = by_closure || bounds.lower[i] == bounds.upper[i];
  }
  for (int pair = 0; pair < problem.pairs(); ++pair) {
    if (problem.pair_group(pair) < 0 || states.is_open[at(pair)]) continue;
    const int side = states.sides[at(pair)] == ActiveSide::G ? pair : problem.pairs() + pair;
    if (problem.signs()[at(side)] != Sign::implied) continue;
    for (const linalg::Entry entry : jacobian.along(problem.constraints() + side)) {
      if (entry.value != 0.0) is_held[at(entry.inner)] = true;
    }
  }
  return is_held;
}

bool can_move(const RowMatrix& jacobian, const std::vector<bool>& is_held, const std::vector<int>& rows) {
  for (const int row : rows) {
    for (const linalg::Entry entry : jacobian.along(row)) {
      if (entry.value != 0.0 && !is_held[at(entry.inner)]) return true;
    }
  }
  return false;
}

void add_constraints(mpcc::Problem& problem, const linalg::Vector& c, const PairStates& states,
                     const crossover::Reduction* reduction, Rows& rows) {
  const int n_g = problem.constraints();
  const auto& bounds = problem.constraint_bounds();
  std::vector<bool> is_dropped(at(n_g), false);
  if (reduction != nullptr) {
    for (const int row : problem.close_branch(states.sides).dropped_rows) is_dropped[at(row)] = true;
    for (std::size_t i = 0; i < reduction->place.size(); ++i) {
      const int place = reduction->place[i];
      if (place >= 0 && reduction->leader[at(place)] != static_cast<int>(i)) {
        rows.add_equality(static_cast<int>(i), reduction->leader[at(place)]);
      }
    }
  }
  for (int row = 0; row < n_g; ++row) {
    if (!is_dropped[at(row)]) rows.add(row, c[row], bounds.lower[row], bounds.upper[row]);
  }
  for (int side = 0; side < 2 * problem.pairs(); ++side) {
    const int pair = side % problem.pairs();
    if (problem.pair_group(pair) < 0 || problem.signs()[at(side)] == Sign::implied) continue;
    const auto own = side < problem.pairs() ? ActiveSide::G : ActiveSide::H;
    const bool is_zero = !states.is_open[at(pair)] && states.sides[at(pair)] == own;
    rows.add(n_g + side, is_zero ? 0.0 : c[n_g + side], 0.0, is_zero ? 0.0 : unlimited);
  }
}

}  // namespace

Linearisation linearise(mpcc::Problem& problem, ConstVectorView w, const PairStates& states,
                        const crossover::Reduction* reduction, double radius) {
  const int n = problem.variables();
  const int n_g = problem.constraints();
  const RowMatrix jacobian = jacobian_matrix(problem, w);
  linalg::Vector c(problem.rows());
  problem.functions(w, c);
  Linearisation result;
  LpccProblem& lpcc = result.problem;
  lpcc.cost.resize(n);
  problem.objective_gradient(w, lpcc.cost);
  result.scale = std::max(1.0, lpcc.cost.max_abs());
  const std::vector<bool> is_held = find_held(problem, jacobian, states, reduction);
  const auto& bounds = problem.variable_bounds();
  lpcc.variables.lower = ((bounds.lower - w) / radius).at_least(-1.0).at_most(0.0);
  lpcc.variables.upper = ((bounds.upper - w) / radius).at_most(1.0).at_least(0.0);
  for (int i = 0; i < n; ++i) {
    if (is_held[at(i)]) lpcc.variables.lower[i] = lpcc.variables.upper[i] = 0.0;
  }
  Rows rows(jacobian, is_held, radius);
  add_constraints(problem, c, states, reduction, rows);
  for (const auto& group : crossover::groups_of(problem)) {
    if (!states.is_open[at(group.front())]) continue;
    std::vector<int> of_G;
    std::vector<int> of_H;
    for (const int pair : group) {
      of_G.push_back(n_g + pair);
      of_H.push_back(n_g + problem.pairs() + pair);
    }
    // A side that cannot move is zero already: nothing to choose.
    if (!can_move(jacobian, is_held, of_G) || !can_move(jacobian, is_held, of_H)) continue;
    const int first = rows.add_sum(of_G);
    lpcc.disjunctions.emplace_back(first, rows.add_sum(of_H));
    result.groups.push_back(group);
  }
  rows.finish(lpcc);
  return result;
}

}  // namespace saltus::solver::certificate
