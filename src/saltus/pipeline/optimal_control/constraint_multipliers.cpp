#include <cmath>
#include <limits>

#include "saltus/adapters/highs/highs_lpcc.hpp"
#include "saltus/pipeline/optimal_control/constraint_multipliers_internal.hpp"

namespace saltus::pipeline {
namespace {

/// A bound with less does not press.
constexpr double smallest_pressure = 1e-9;

}  // namespace

std::vector<result::ConstraintMultiplier> constraint_multipliers(const discretization::OcpProblem& problem,
                                                                 const solver::Solution& solution) {
  const auto& multipliers = solution.multipliers;
  const int rows = problem.constraints();
  if (multipliers.rows.size() != rows) return {};
  linalg::Vector bounds;
  if (multipliers.upper.size() == problem.variables()) bounds = multipliers.upper - multipliers.lower;
  auto found = problem.constraint_multipliers(solution.w, multipliers.rows, bounds);
  if (!solution.multiplier_set || solution.multiplier_set->is_unique()) return found;
  // Which row or variable each of them belongs to: the same list of their numbers, behind those of rows and one more.
  linalg::Vector row_numbers(rows), bound_numbers = bounds;
  for (int row = 0; row < rows; ++row) row_numbers[row] = row;
  for (linalg::Index i = 0; i < bounds.size(); ++i) {
    bound_numbers[i] = std::abs(bounds[i]) < smallest_pressure ? 0.0 : static_cast<double>(rows + 1 + i);
  }
  const auto numbers = problem.constraint_multipliers(solution.w, row_numbers, bound_numbers);
  adapters::HighsLpcc linear;
  for (std::size_t k = 0; k < found.size(); ++k) {
    const int number = static_cast<int>(numbers[k].value);
    const auto range = number < rows ? solution.multiplier_set->of_row(number, linear)
                                     : solution.multiplier_set->of_bounds(number - rows - 1, linear);
    if (range.is_unique()) continue;
    found[k].value = std::numeric_limits<double>::quiet_NaN();
    found[k].range = {range.lower, range.upper};
  }
  return found;
}

}  // namespace saltus::pipeline
