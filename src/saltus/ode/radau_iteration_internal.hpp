// The simplified Newton iteration of a Radau IIA method, and its Jacobian.
#pragma once

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <utility>
#include <vector>

#include "saltus/ode/radau_steps_internal.hpp"
#include "saltus/ode/step_checks_internal.hpp"

namespace saltus::ode {

inline constexpr double radau_epsilon = std::numeric_limits<double>::epsilon();
inline constexpr double smallest_normal = std::numeric_limits<double>::min();

/// From half the significant digits on, iterates may be rounding: their ratio says nothing about the convergence.
inline constexpr double half_digits = 0x1p-26;
/// A Jacobian with which the iteration converges at least this fast is kept (THET of the code RADAU5).
inline constexpr double keep_rate = 1e-3;
/// With a Jacobian of an earlier step: slower than this, a new one is cheaper than the iterations.
inline constexpr double renew_rate = 0.1;
inline constexpr int most_iterations = 30;
/// With differences, from one start: a step that is only too long fails less often.
inline constexpr int most_failures = 3;
/// Lengths of two steps that share their factors: the rate of convergence is changed by as much.
inline constexpr double same_length = 0x1p-20;

inline double natural_size(const Tolerances& tolerances) {
  return tolerances.rtol > 0.0 ? tolerances.atol / tolerances.rtol : 0.0;
}

/// Iterates until the next correction would be a rounding, or corrections are rounding and no longer fall.
template <class Tableau>
auto RadauSteps<Tableau>::iterate(const RadauTrial& trial) -> Stages {
  const double stagnation = std::clamp(1e-2 * trial.tolerances.rtol, 1e3 * radau_epsilon, 1e-8);
  double previous = 0.0;
  rate_ = 0.0;
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    if (!stage_slopes(trial)) return Stages::undefined;
    const double size = correct(trial);
    if (!std::isfinite(size)) return Stages::singular;
    if (size <= radau_epsilon) return Stages::found;
    if (iteration > 0) {
      const double rate = size / previous;
      if (previous > half_digits) rate_ = std::max(rate_, rate);
      if (rate < 1.0 && next_ <= radau_epsilon * (1.0 - rate)) return Stages::found;
      if (rate > 0.5 && size <= stagnation) return Stages::found;
      if (rate >= 2.0 || (rate >= 1.0 && iteration > 2)) return Stages::not_found;
      if (rate > renew_rate && !jacobian_here_ && size > stagnation) return Stages::not_found;
    }
    previous = size;
  }
  return Stages::not_found;
}

template <class Tableau>
bool RadauSteps<Tableau>::stage_slopes(const RadauTrial& trial) {
  for (linalg::Index j = 0; j <= last; ++j) {
    work_.argument = start_;
    work_.argument += z_.col(j);
    const double t = trial.t + Tableau::c[at(j)] * trial.h;
    if (!evaluate(trial, t, work_.argument, slopes_.col(j).data())) return false;
  }
  return true;
}

/// Solves for the corrections of the transformed increments (IV.8.4).
template <class Tableau>
void RadauSteps<Tableau>::solve_systems(double h) {
  const auto mixed = [&](std::size_t row, linalg::Index i) {
    const auto& weights = Tableau::t_inverse[row];
    double sum = weights[0] * slopes_(i, 0);
    for (std::size_t j = 1; j < stages; ++j) sum += weights[j] * slopes_(i, static_cast<linalg::Index>(j));
    return sum;
  };
  auto& right = work_.all_right;
  for (linalg::Index i = 0; i < n_; ++i) right(i, 0) = mixed(0, i) - Tableau::gamma / h * w_(i, 0);
  for (std::size_t k = 0; k < stages / 2; ++k) {
    const auto [alpha, beta] = Tableau::pairs[k];
    const auto real = static_cast<linalg::Index>(2 * k + 1);
    for (linalg::Index i = 0; i < n_; ++i) {
      const double u = w_(i, real);
      const double v = w_(i, real + 1);
      right(i, real) = mixed(2 * k + 1, i) - (alpha * u - beta * v) / h;
      right(i, real + 1) = mixed(2 * k + 2, i) - (beta * u + alpha * v) / h;
    }
  }
  systems_.solve_all(right, corrections_);
}

/// Makes one Newton correction; returns its largest component relative to the size of the component. What the next one
/// will be is seen in each component: where x' = v, a first correction of x says nothing about later ones of v.
template <class Tableau>
double RadauSteps<Tableau>::correct(const RadauTrial& trial) {
  solve_systems(trial.h);
  const double floor = natural_size(trial.tolerances);
  double largest = 0.0;
  next_ = 0.0;
  for (linalg::Index i = 0; i < n_; ++i) {
    double change = 0.0;
    double size = std::abs(start_[i]) + floor;
    for (linalg::Index j = 0; j <= last; ++j) {
      const auto& row = Tableau::t[at(j)];
      double dz = row[0] * corrections_(i, 0);
      for (std::size_t k = 1; k < stages; ++k) dz += row[k] * corrections_(i, static_cast<linalg::Index>(k));
      w_(i, j) += corrections_(i, j);
      z_(i, j) += dz;
      change = std::max(change, std::abs(dz));
      size = std::max(size, std::abs(z_(i, j)));
      if (!std::isfinite(dz)) return std::numeric_limits<double>::infinity();
    }
    const double part = change / std::max(size, smallest_normal), before = std::exchange(work_.changes[i], part);
    largest = std::max(largest, part);
    if (part > radau_epsilon) next_ = std::max(next_, part * (part / before));
  }
  return largest;
}

template <class Tableau>
bool RadauSteps<Tableau>::differentiate(const RadauTrial& trial) {
  const bool failed = failures_ >= most_failures;
  const bool is_known =
      (failed && take_derivatives(trial)) || take_differences(trial) || (!failed && take_derivatives(trial));
  if (!is_known) return false;
  jacobian_known_ = jacobian_here_ = true;
  factors_.known = false;
  return true;
}

template <class Tableau>
bool RadauSteps<Tableau>::take_derivatives(const RadauTrial& trial) {
  return trial.jacobian != nullptr && (*trial.jacobian)(trial.t, start_.data(), systems_.entries()) &&
         systems_.all_finite();
}

/// Takes forward differences, each into the direction in which the solution goes: a domain that ends at the start is
/// not left.
template <class Tableau>
bool RadauSteps<Tableau>::take_differences(const RadauTrial& trial) {
  largest_ = start_.max_abs();
  const auto either_way = [&](const std::vector<std::size_t>& columns) {
    return difference(trial, columns, +1.0) || difference(trial, columns, -1.0);
  };
  for (const auto& columns : systems_.groups()) {
    if (!either_way(columns)) return false;
  }
  for (linalg::Index j = 0; !systems_.is_sparse() && j < n_; ++j) {
    one_column_.front() = static_cast<std::size_t>(j);
    if (!either_way(one_column_)) return false;
  }
  return true;
}

template <class Tableau>
double RadauSteps<Tableau>::increment(const RadauTrial& trial, linalg::Index column, double largest) const {
  const auto& tolerances = trial.tolerances;
  const double natural = half_digits * natural_size(tolerances);
  const double floor = tolerances.rtol > 0.0 ? std::min(tolerances.atol, natural) : tolerances.atol;
  const double reach = trial.h * trial.slope[column];
  double increment = std::max(half_digits * std::max(std::abs(start_[column]), std::abs(reach)), floor);
  if (!(increment >= smallest_normal)) increment = half_digits * (largest > 0.0 ? largest : 1.0);
  return std::copysign(increment, reach);
}

/// Takes the difference of columns that have no row in common, all at once.
template <class Tableau>
bool RadauSteps<Tableau>::difference(const RadauTrial& trial, const std::vector<std::size_t>& columns,
                                     double direction) {
  work_.argument = start_;
  for (const std::size_t column : columns) {
    const auto j = static_cast<linalg::Index>(column);
    work_.argument[j] += direction * increment(trial, j, largest_);
  }
  if (!evaluate(trial, trial.t, work_.argument, work_.difference_slope.data())) return false;
  work_.difference_slope -= linalg::ConstView(trial.slope, n_);
  bool finite = true;
  for (const std::size_t column : columns) {
    const auto j = static_cast<linalg::Index>(column);
    finite = systems_.set_column(j, work_.difference_slope, work_.argument[j] - start_[j]) && finite;
  }
  return finite;
}

}  // namespace saltus::ode
