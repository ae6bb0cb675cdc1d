#include "saltus/solver/certificate/active_constraints.hpp"

#include <algorithm>
#include <cmath>

#include "saltus/base/at.hpp"
#include "saltus/linalg/block_ldl.hpp"
#include "saltus/linalg/block_order.hpp"
#include "saltus/solver/crossover/corrector_internal.hpp"

namespace saltus::solver::certificate {
namespace {

At place_between(double value, double lower, double upper, double tolerance) {
  const auto is_near = [&](double bound) {
    return std::isfinite(bound) && std::abs(value - bound) <= tolerance * std::max(1.0, std::abs(bound));
  };
  if (lower == upper) return At::both;
  if (is_near(lower)) return is_near(upper) ? At::both : At::lower;
  return is_near(upper) ? At::upper : At::none;
}

bool is_inequality(At at) { return at == At::lower || at == At::upper; }

/// Rows of g that are none of the branch problem although the user states them.
void find_rows_of_held(mpcc::Problem& problem, const crossover::Branch& branch, const RowMatrix& jacobian,
                       const linalg::Vector& c, double tolerance, ActiveConstraints& active) {
  std::vector<bool> is_known(at(problem.rows()), false);
  for (const auto* rows : {&branch.problem->reduction().rows, &branch.problem->left_out()}) {
    for (const int row : *rows) is_known[at(row)] = true;
  }
  for (const int row : problem.close_branch(branch.sides).dropped_rows) is_known[at(row)] = true;
  const auto& bounds = problem.constraint_bounds();
  for (int row = 0; row < problem.constraints(); ++row) {
    const At at_bound = place_between(c[row], bounds.lower[row], bounds.upper[row], tolerance);
    if (is_known[at(row)] || at_bound == At::none) continue;
    bool has_variable = false;
    for (const linalg::Entry entry : jacobian.along(row)) has_variable = has_variable || entry.value != 0.0;
    if (has_variable) active.held.push_back({row, at_bound, 0.0});
  }
}

}  // namespace

ActiveConstraints ActiveConstraints::strongly(const NlpPoint& point, double zero) const {
  ActiveConstraints strong{.bounds = bounds, .rows = {}, .held = held};
  for (std::size_t i = 0; i < bounds.size(); ++i) {
    const double pressure = std::abs(point.z_lower[index(i)] - point.z_upper[index(i)]);
    if (is_inequality(bounds[i]) && pressure <= zero) strong.bounds[i] = At::none;
  }
  for (const ActiveRow& row : rows) {
    if (!is_inequality(row.at) || std::abs(row.multiplier) > zero) strong.rows.push_back(row);
  }
  return strong;
}

ActiveConstraints find_active(mpcc::Problem& problem, crossover::Branch& branch, double tolerance) {
  const auto& reduction = branch.problem->reduction();
  const NlpPoint& point = branch.point;
  ActiveConstraints active;
  for (linalg::Index i = 0; i < point.w.size(); ++i) {
    active.bounds.push_back(place_between(point.w[i], reduction.bounds.lower[i], reduction.bounds.upper[i], tolerance));
  }
  const linalg::Vector w = branch.problem->full(point.w);
  linalg::Vector c(problem.rows());
  problem.functions(w, c);
  for (std::size_t i = 0; i < reduction.rows.size(); ++i) {
    const int row = reduction.rows[i];
    const At at_bound =
        place_between(c[row], reduction.row_bounds.lower[index(i)], reduction.row_bounds.upper[index(i)], tolerance);
    if (at_bound != At::none) active.rows.push_back({row, at_bound, point.y[index(i)]});
  }
  for (const int row : branch.problem->left_out()) active.rows.push_back({row, At::both, 0.0});
  find_rows_of_held(problem, branch, jacobian_matrix(problem, w), c, tolerance, active);
  return active;
}

int ActiveGradients::variables() const {
  return static_cast<int>(std::count_if(column.begin(), column.end(), [](int i) { return i >= 0; }));
}

ActiveGradients gradients_of(const ActiveConstraints& active, const crossover::Reduction& reduction,
                             const RowMatrix& jacobian) {
  ActiveGradients result;
  int free = 0;
  for (const At at_bound : active.bounds) result.column.push_back(at_bound == At::none ? free++ : -1);
  std::vector<linalg::Triplet> entries;
  std::vector<double> gradient(at(std::max(free, 1)), 0.0);
  for (std::size_t j = 0; j < active.rows.size(); ++j) {
    std::vector<int> touched;
    double all = 0.0;
    for (const linalg::Entry entry : jacobian.along(active.rows[j].row)) {
      all = std::max(all, std::abs(entry.value));
      const int place = reduction.place[at(entry.inner)];
      if (place < 0 || result.column[at(place)] < 0 || entry.value == 0.0) continue;
      const int column = result.column[at(place)];
      if (gradient[at(column)] == 0.0) touched.push_back(column);
      gradient[at(column)] += entry.value;
    }
    double squares = 0.0;
    for (const int i : touched) squares += gradient[at(i)] * gradient[at(i)];
    const double size = std::sqrt(squares);
    const bool is_zero = size <= dependence * all;
    result.size.push_back(is_zero ? 1.0 : size);
    for (const int i : touched) {
      if (!is_zero && gradient[at(i)] != 0.0) entries.push_back({i, index(j), gradient[at(i)] / size});
      gradient[at(i)] = 0.0;
    }
  }
  result.matrix = linalg::SparseColumns(std::max(free, 1), index(active.rows.size()), entries);
  return result;
}

bool has_saddle_inertia(const crossover::Symmetric& system, int rows) {
  linalg::BlockLdl factors;
  factors.analyse(system.size, system.rows, system.columns,
                  linalg::blocks_by_minimum_degree(system.size, rows, system.rows, system.columns));
  const int positive = static_cast<int>(system.size) - rows;
  return factors.factorise(system.values) == linalg::Inertia{.positive = positive, .negative = rows, .zero = 0};
}

bool are_independent(const ActiveGradients& gradients) {
  constexpr double least = 1e-6;
  const int n = gradients.variables();
  const auto rows = static_cast<int>(gradients.matrix.cols());
  if (rows == 0) return true;
  if (rows > n) return false;
  crossover::Symmetric system;
  system.size = n + rows;
  for (int i = 0; i < n; ++i) system.add(i, i, 1.0);
  for (int j = 0; j < rows; ++j) {
    for (const linalg::Entry entry : gradients.matrix.along(j)) system.add(n + j, entry.inner, entry.value);
    system.add(n + j, n + j, least * least);
  }
  return has_saddle_inertia(system, rows);
}

}  // namespace saltus::solver::certificate
