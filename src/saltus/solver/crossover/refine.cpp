#include "saltus/solver/crossover/refine.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "saltus/base/at.hpp"
#include "saltus/linalg/sparse_factors.hpp"
#include "saltus/solver/crossover/corrector_internal.hpp"
#include "saltus/solver/sparse.hpp"

namespace saltus::solver::crossover {
namespace {

using Matrix = linalg::SparseColumns;

constexpr int largest_steps = 12;
/// An error from which no step leads back.
constexpr double lost = 1.0;
/// Where bounds are weakly active, snapping onto them must not cost more feasibility than this.
constexpr double allowed_violation = 1e-11;

struct Values {
  linalg::Vector gradient;
  linalg::Vector c;
  RowMatrix jacobian;
};

Values evaluate(mpcc::Problem& nlp, ConstVectorView v) {
  Values values{.gradient = linalg::Vector(nlp.variables()), .c = linalg::Vector(nlp.constraints()), .jacobian = {}};
  nlp.objective_gradient(v, values.gradient);
  nlp.functions(v, values.c);
  values.jacobian = jacobian_matrix(nlp, v);
  return values;
}

/// Of one inequality lower <= x <= upper with multiplier `pressure` > 0 at the upper bound, < 0 at the lower one.
double inequality_error(double x, double lower, double upper, double pressure) {
  const double violation = std::max({lower - x, x - upper, 0.0});
  if (lower == upper) return violation;
  const double at_upper = pressure > 0.0 ? std::min(pressure, std::abs(upper - x)) : 0.0;
  const double at_lower = pressure < 0.0 ? std::min(-pressure, std::abs(x - lower)) : 0.0;
  return std::max({violation, at_upper, at_lower});
}

/// The largest violation of bounds and rows.
double violation_of(mpcc::Problem& nlp, const NlpPoint& point, const Values& values) {
  const auto largest = [](const linalg::Vector& x, const mpcc::Bounds& bounds) {
    return x.size() == 0 ? 0.0 : std::max((bounds.lower - x).max(), (x - bounds.upper).max());
  };
  return std::max({largest(point.w, nlp.variable_bounds()), largest(values.c, nlp.constraint_bounds()), 0.0});
}

double error_of(mpcc::Problem& nlp, const NlpPoint& point, const Values& values) {
  const auto& bounds = nlp.variable_bounds();
  const auto& rows = nlp.constraint_bounds();
  const linalg::Vector slope =
      values.gradient + values.jacobian.transposed_times(point.y) - point.z_lower + point.z_upper;
  double error = slope.max_abs();
  for (linalg::Index i = 0; i < point.w.size(); ++i) {
    const double pressure = point.z_upper[i] - point.z_lower[i];
    error = std::max(error, inequality_error(point.w[i], bounds.lower[i], bounds.upper[i], pressure));
  }
  for (linalg::Index i = 0; i < point.y.size(); ++i) {
    error = std::max(error, inequality_error(values.c[i], rows.lower[i], rows.upper[i], point.y[i]));
  }
  return std::isfinite(slope.sum() + values.c.sum()) ? error : std::numeric_limits<double>::infinity();
}

ActiveSet find_active_set(mpcc::Problem& nlp, const NlpPoint& point, const linalg::Vector& c) {
  const auto& bounds = nlp.variable_bounds();
  const auto& rows = nlp.constraint_bounds();
  ActiveSet active;
  active.held = point.w;
  active.target = c;
  for (linalg::Index i = 0; i < point.w.size(); ++i) {
    const bool at_lower = point.z_lower[i] > point.w[i] - bounds.lower[i];
    const bool at_upper = !at_lower && point.z_upper[i] > bounds.upper[i] - point.w[i];
    if (at_lower) active.held[i] = bounds.lower[i];
    if (at_upper) active.held[i] = bounds.upper[i];
    active.column.push_back(at_lower || at_upper ? -1 : active.variables++);
  }
  for (linalg::Index i = 0; i < c.size(); ++i) {
    const bool at_lower = rows.lower[i] == rows.upper[i] || -point.y[i] > c[i] - rows.lower[i];
    const bool at_upper = !at_lower && point.y[i] > rows.upper[i] - c[i];
    if (at_lower) active.target[i] = rows.lower[i];
    if (at_upper) active.target[i] = rows.upper[i];
    active.line.push_back(at_lower || at_upper ? active.rows++ : -1);
  }
  return active;
}

/// [H A'; A 0] of the free variables and active rows, without regularisation. Its places do not depend on the point.
Symmetric system_of(mpcc::Problem& nlp, const NlpPoint& point, const Values& values, const ActiveSet& active) {
  Symmetric system;
  system.size = active.variables + active.rows;
  linalg::Vector entries(nlp.hessian_pattern().entries());
  nlp.hessian(point.w, 1.0, point.y, entries);
  const auto& pattern = nlp.hessian_pattern();
  for (int e = 0; e < pattern.entries(); ++e) {
    const int row = active.column[at(pattern.row[at(e)])];
    const int column = active.column[at(pattern.column[at(e)])];
    if (row >= 0 && column >= 0) system.add(row, column, entries[e]);
  }
  for (int row = 0; row < values.jacobian.rows(); ++row) {
    const int line = active.line[at(row)];
    if (line < 0) continue;
    for (const linalg::Entry entry : values.jacobian.along(row)) {
      const int column = active.column[at(entry.inner)];
      if (column >= 0) system.add(active.variables + line, column, entry.value);
    }
  }
  return system;
}

/// Multipliers of active bounds from stationarity; those of the others are zero.
void set_bound_multipliers(NlpPoint& point, const Values& values, const ActiveSet& active, const mpcc::Bounds& bounds) {
  const linalg::Vector slope = values.gradient + values.jacobian.transposed_times(point.y);
  point.z_lower.set_zero();
  point.z_upper.set_zero();
  for (linalg::Index i = 0; i < slope.size(); ++i) {
    if (active.column[at(i)] >= 0) continue;
    const bool at_lower = active.held[i] == bounds.lower[i];
    const bool at_upper = active.held[i] == bounds.upper[i];
    if (at_lower) point.z_lower[i] = at_upper ? std::max(slope[i], 0.0) : slope[i];
    if (at_upper) point.z_upper[i] = at_lower ? std::max(-slope[i], 0.0) : -slope[i];
  }
}

/// What the optimality conditions of the active set lack.
linalg::Vector right_side_of(const NlpPoint& point, const Values& values, const ActiveSet& active) {
  const linalg::Vector slope = values.gradient + values.jacobian.transposed_times(point.y);
  linalg::Vector right(active.variables + active.rows);
  for (linalg::Index i = 0; i < slope.size(); ++i) {
    if (active.column[at(i)] >= 0) right[active.column[at(i)]] = -slope[i];
  }
  for (linalg::Index i = 0; i < values.c.size(); ++i) {
    if (active.line[at(i)] >= 0) right[active.variables + active.line[at(i)]] = active.target[i] - values.c[i];
  }
  return right;
}

void add_correction(const linalg::Vector& d, const ActiveSet& active, NlpPoint& point) {
  for (linalg::Index i = 0; i < point.w.size(); ++i) {
    if (active.column[at(i)] >= 0) point.w[i] += d[active.column[at(i)]];
  }
  for (linalg::Index i = 0; i < point.y.size(); ++i) {
    if (active.line[at(i)] >= 0) point.y[i] += d[active.variables + active.line[at(i)]];
  }
}

/// A multiplier of the wrong sign says that the active set was guessed wrong.
bool has_right_signs(const NlpPoint& point, double tolerance) {
  return point.w.size() == 0 || std::min(point.z_lower.min(), point.z_upper.min()) >= -tolerance;
}

}  // namespace

double optimality_error(mpcc::Problem& nlp, const NlpPoint& point) {
  return error_of(nlp, point, evaluate(nlp, point.w));
}

double refine(mpcc::Problem& nlp, NlpPoint& point) {
  Values values = evaluate(nlp, point.w);
  double best = error_of(nlp, point, values);
  double violation = violation_of(nlp, point, values);
  if (nlp.variables() == 0 || !std::isfinite(best)) return best;
  const ActiveSet active = find_active_set(nlp, point, values.c);
  NlpPoint trial = point;
  trial.w = active.held;
  for (linalg::Index i = 0; i < trial.y.size(); ++i) {
    if (active.line[at(i)] < 0) trial.y[i] = 0.0;
  }
  Corrector corrector(nlp, active);
  double last = std::numeric_limits<double>::infinity();
  for (int step = 0; step < largest_steps; ++step) {
    values = evaluate(nlp, trial.w);
    set_bound_multipliers(trial, values, active, nlp.variable_bounds());
    const double error = error_of(nlp, trial, values);
    const double trial_violation = violation_of(nlp, trial, values);
    if (error < best && trial_violation <= std::max(violation, allowed_violation) &&
        has_right_signs(trial, std::max(1e-9, error))) {
      best = error;
      violation = trial_violation;
      point = trial;
    }
    // Quadratic until rounding is reached, from where it stands still; a step that makes it worse comes from afar, one
    // that makes it much worse from a system that is singular.
    if (!(error < lost) || (step > 3 && error > 0.5 * last)) break;
    last = error;
    if (active.variables + active.rows == 0) break;
    const linalg::Vector d =
        corrector.solve(system_of(nlp, trial, values, active), right_side_of(trial, values, active));
    if (!d.all_finite()) break;
    add_correction(d, active, trial);
  }
  return best;
}

std::vector<int> dependent_equations(mpcc::Problem& nlp, ConstVectorView v) {
  if (nlp.variables() == 0) return {};
  const RowMatrix jacobian = jacobian_matrix(nlp, v);
  const auto& rows = nlp.constraint_bounds();
  std::vector<int> equations;
  std::vector<linalg::Triplet> triplets;
  for (int row = 0; row < nlp.constraints(); ++row) {
    if (rows.lower[row] != rows.upper[row]) continue;
    for (const linalg::Entry entry : jacobian.along(row)) {
      triplets.push_back({entry.inner, index(equations.size()), entry.value});
    }
    equations.push_back(row);
  }
  if (equations.empty()) return {};
  const Matrix transposed(nlp.variables(), index(equations.size()), triplets);
  // At a point near a branch, rows that depend on each other there do so to the square root of the last sigma only.
  const double size = transposed.norm() / std::sqrt(1.0 + static_cast<double>(equations.size()));
  std::vector<int> dependent;
  for (const linalg::Index i : linalg::dependent_columns(transposed, 1e-6 * std::max(1.0, size))) {
    dependent.push_back(equations[at(i)]);
  }
  return dependent;
}

}  // namespace saltus::solver::crossover
