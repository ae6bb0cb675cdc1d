#include "saltus/solver/certificate/second_order.hpp"

#include <algorithm>
#include <cmath>

#include "saltus/base/at.hpp"
#include "saltus/solver/crossover/corrector_internal.hpp"

namespace saltus::solver::certificate {
namespace {

/// A curvature that is rounding, relative to the largest entry of the Hessian.
constexpr double small_curvature = 1e-8;

/// Whether H + shift is positive on the directions that all these constraints leave.
bool is_positive(crossover::Branch& branch, const ActiveConstraints& active, const RowMatrix& jacobian,
                 const linalg::Vector& hessian, double shift) {
  auto& nlp = *branch.problem;
  const ActiveGradients gradients = gradients_of(active, nlp.reduction(), jacobian);
  const int n = gradients.variables();
  if (n == 0) return true;
  std::vector<int> line(active.rows.size(), 0);
  if (!are_independent(gradients)) {
    for (const linalg::Index j : linalg::dependent_columns(gradients.matrix, dependence)) line[at(j)] = -1;
  }
  int rows = 0;
  for (int& place : line) place = place < 0 ? -1 : n + rows++;
  if (rows >= n) return true;
  crossover::Symmetric system;
  system.size = n + rows;
  const auto& pattern = nlp.hessian_pattern();
  for (int e = 0; e < pattern.entries(); ++e) {
    const int row = gradients.column[at(pattern.row[at(e)])], column = gradients.column[at(pattern.column[at(e)])];
    if (row >= 0 && column >= 0) system.add(row, column, hessian[e]);
  }
  for (int i = 0; i < n; ++i) system.add(i, i, shift);
  for (std::size_t j = 0; j < line.size(); ++j) {
    if (line[j] < 0) continue;
    for (const linalg::Entry entry : gradients.matrix.along(index(j))) system.add(line[j], entry.inner, entry.value);
  }
  return has_saddle_inertia(system, rows);
}

}  // namespace

std::optional<bool> is_second_order_sufficient(mpcc::Problem& problem, crossover::Branch& branch,
                                               const ActiveConstraints& active, double zero) {
  auto& nlp = *branch.problem;
  linalg::Vector hessian(nlp.hessian_pattern().entries());
  nlp.hessian(branch.point.w, 1.0, branch.point.y, hessian);
  if (!hessian.all_finite()) return std::nullopt;
  const RowMatrix jacobian = jacobian_matrix(problem, nlp.full(branch.point.w));
  const double shift = small_curvature * std::max(1.0, hessian.max_abs());
  if (is_positive(branch, active.strongly(branch.point, zero), jacobian, hessian, -shift)) return true;
  if (!is_positive(branch, active, jacobian, hessian, shift)) return false;
  return std::nullopt;
}

}  // namespace saltus::solver::certificate
