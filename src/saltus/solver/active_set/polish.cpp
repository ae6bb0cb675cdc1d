#include "saltus/solver/active_set/polish.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "saltus/base/at.hpp"
#include "saltus/base/contains.hpp"
#include "saltus/linalg/factors.hpp"

namespace saltus::solver::active_set {
namespace {

using mpcc::ActiveSide;

/// Newton's method ends when the residual is so small or does not fall any more.
bool newton(mpcc::Problem& problem, const std::vector<ActiveSide>& sides, const PolishOptions& options,
            linalg::Vector& w) {
  double best = std::numeric_limits<double>::infinity();
  linalg::Vector trial = w;
  for (int i = 0; i < options.iterations; ++i) {
    const ActiveSystem system = active_system(problem, trial, sides, options.active);
    const double size = system.residual.max_abs();
    if (!(size < best)) break;
    best = size;
    w = trial;
    if (size == 0.0) break;
    linalg::OrthogonalFactors factors;
    // Rows that a pair and its neighbours share agree to rounding only: their difference is no direction.
    factors.set_threshold(1e-10);
    factors.compute(system.jacobian);
    trial -= factors.solve(system.residual);
    if (!trial.all_finite()) break;
  }
  return best <= options.tolerance;
}

/// Where one side of a biactive pair is less than `far` times the other, that side: both may be small in a solution.
std::vector<ActiveSide> smaller_sides(mpcc::Problem& problem, const linalg::Vector& w, std::vector<ActiveSide> sides,
                                      double far) {
  linalg::Vector c(problem.rows());
  problem.functions(w, c);
  for (int i = 0; i < problem.pairs(); ++i) {
    auto& side = sides[at(i)];
    const double G = std::abs(c[problem.constraints() + i]);
    const double H = std::abs(c[problem.constraints() + problem.pairs() + i]);
    if (side != ActiveSide::biactive) continue;
    if (G < far * H) side = ActiveSide::G;
    if (H < far * G) side = ActiveSide::H;
  }
  return sides;
}

std::vector<ActiveSide> without_biactive(std::vector<ActiveSide> sides) {
  std::replace(sides.begin(), sides.end(), ActiveSide::biactive, ActiveSide::none);
  return sides;
}

/// A row that is zero is an equation of its own, or says that variables are at their bounds.
enum class RowRole { none, own, by_bounds };

std::vector<RowRole> roles_of_rows(const mpcc::Problem& problem, const std::vector<ActiveSide>& sides) {
  const int n_g = problem.constraints();
  const int pairs = problem.pairs();
  const auto& rows = problem.constraint_bounds();
  std::vector<RowRole> role(at(problem.rows()), RowRole::none);
  for (int row = 0; row < n_g; ++row) {
    if (rows.lower[row] == rows.upper[row]) role[at(row)] = RowRole::own;
  }
  for (int side = 0; side < 2 * pairs; ++side) {
    const ActiveSide zero = sides[at(side % pairs)];
    const bool is_zero = zero == ActiveSide::biactive || zero == (side < pairs ? ActiveSide::G : ActiveSide::H);
    const bool is_implied = problem.signs()[at(side)] == mpcc::Sign::implied;
    if (is_zero) role[at(n_g + side)] = is_implied ? RowRole::by_bounds : RowRole::own;
  }
  return role;
}

}  // namespace

ActiveSystem active_system(mpcc::Problem& problem, mpcc::ConstVectorView w, const std::vector<ActiveSide>& sides,
                           double negligible) {
  const int n_g = problem.constraints();
  const auto& rows = problem.constraint_bounds();
  const auto& box = problem.variable_bounds();
  linalg::Vector c(problem.rows());
  linalg::Vector entries(problem.jacobian_pattern().entries());
  problem.functions(w, c);
  problem.jacobian(w, entries);

  const std::vector<RowRole> role = roles_of_rows(problem, sides);
  std::vector<int> place(role.size(), -1);
  std::vector<double> residual;
  for (int row = 0; row < problem.rows(); ++row) {
    if (role[at(row)] != RowRole::own) continue;
    place[at(row)] = static_cast<int>(residual.size());
    residual.push_back(c[row] - (row < n_g ? rows.lower[row] : 0.0));
  }
  const auto& pattern = problem.jacobian_pattern();
  std::vector<int> fixed(static_cast<std::size_t>(problem.variables()), 0);  // -1, 1: at its lower, upper bound
  for (std::size_t e = 0; e < pattern.row.size(); ++e) {
    const double slope = entries[static_cast<linalg::Index>(e)];
    if (role[at(pattern.row[e])] != RowRole::by_bounds || std::abs(slope) <= negligible) continue;
    fixed[at(pattern.column[e])] = slope > 0.0 ? -1 : 1;
  }
  std::vector<int> fixed_variables;
  for (int i = 0; i < problem.variables(); ++i) {
    const bool is_constant = box.lower[i] == box.upper[i];
    const int side = is_constant ? -1 : fixed[at(i)];
    const double bound = side < 0 ? box.lower[i] : box.upper[i];
    if (side == 0 || !std::isfinite(bound)) continue;
    fixed_variables.push_back(i);
    residual.push_back(w[i] - bound);
  }
  const auto equations = static_cast<linalg::Index>(residual.size());
  ActiveSystem system{linalg::ConstView(residual), linalg::Matrix::zero(equations, problem.variables())};
  for (std::size_t e = 0; e < pattern.row.size(); ++e) {
    const int row = place[at(pattern.row[e])];
    if (row >= 0) system.jacobian(row, pattern.column[e]) += entries[static_cast<linalg::Index>(e)];
  }
  linalg::Index row = equations - static_cast<linalg::Index>(fixed_variables.size());
  for (const int i : fixed_variables) system.jacobian(row++, i) = 1.0;
  return system;
}

PolishOutcome polish(mpcc::Problem& problem, linalg::Vector& w, const PolishOptions& options) {
  const auto nearly_zero = mpcc::active_sides(problem, w, options.active);
  if (contains(nearly_zero, ActiveSide::none)) {
    return PolishOutcome::no_active_set;
  }
  const std::vector<ActiveSide> guesses[] = {smaller_sides(problem, w, nearly_zero, 1e-3), nearly_zero,
                                             smaller_sides(problem, w, nearly_zero, 1.0),
                                             without_biactive(nearly_zero)};
  PolishOutcome outcome = PolishOutcome::not_converged;
  for (const auto& sides : guesses) {
    linalg::Vector found = w;
    if (!newton(problem, sides, options, found)) continue;
    if (mpcc::residuals(problem, found).infeasibility() <= options.tolerance) {
      w = found;
      return PolishOutcome::polished;
    }
    outcome = PolishOutcome::violated;
  }
  return outcome;
}

}  // namespace saltus::solver::active_set
