#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>

#include "saltus/base/at.hpp"
#include "saltus/ode/radau5_internal.hpp"
#include "saltus/ode/radau5_tableau.hpp"
#include "saltus/ode/step_checks_internal.hpp"

namespace saltus::ode {
namespace {

using Tableau = Radau5Tableau;
constexpr double epsilon = std::numeric_limits<double>::epsilon();
constexpr double smallest_normal = std::numeric_limits<double>::min();

/// From half the significant digits on, iterates may be rounding: their ratio says nothing about the convergence.
constexpr double half_digits = 0x1p-26;
/// A Jacobian with which the iteration converges at least this fast is kept (THET of the code RADAU5).
constexpr double keep_rate = 1e-3;
/// With a Jacobian of an earlier step: slower than this, a new one is cheaper than the iterations.
constexpr double renew_rate = 0.1;
constexpr int most_iterations = 30;
/// Lengths of two steps that share their factors: the rate of convergence is changed by as much.
constexpr double same_length = 0x1p-20;

double natural_size(const Tolerances& tolerances) {
  return tolerances.rtol > 0.0 ? tolerances.atol / tolerances.rtol : 0.0;
}

}  // namespace

Radau5::Radau5(int n)
    : n_(n),
      start_(n),
      previous_{false, 0.0, std::vector<double>(static_cast<std::size_t>(3 * n))},
      systems_(n),
      z_(n, 3),
      w_(n, 3),
      slopes_(n, 3),
      argument_(n),
      difference_slope_(n),
      right_(n),
      solution_(n),
      complex_right_(n),
      complex_solution_(n) {}

void Radau5::restart() {
  started_ = converged_ = previous_.known = jacobian_known_ = factors_.known = false;
  rate_ = 0.0;
}

Attempt Radau5::attempt(const RadauTrial& trial, double* x_new, double* slope_new, long& evaluations) {
  evaluations_ = &evaluations;
  if (systems_.use(trial.pattern)) jacobian_known_ = factors_.known = false;
  begin(trial);
  h_ = trial.h;
  converged_ = solve(trial) == Outcome::converged;
  if (!converged_) return Attempt::undefined;
  for (Eigen::Index i = 0; i < n_; ++i) x_new[i] = trial.x[i] + z_(i, 2);
  converged_ = all_finite(x_new, static_cast<std::size_t>(n_));
  if (!converged_) return Attempt::undefined;
  error_norm_ = estimate(trial, x_new);
  argument_ = Eigen::Map<const Vector>(x_new, n_);
  return evaluate(trial, trial.t + trial.h, argument_, slope_new) ? Attempt::finite : Attempt::undefined;
}

/// Tells a retaken step from a new one, which may continue the polynomial of the last.
void Radau5::begin(const RadauTrial& trial) {
  const bool retaken = started_ && trial.t == t_ && std::equal(trial.x, trial.x + n_, start_.data());
  if (retaken) return;
  // NOTE: the state may have been projected onto a sliding surface in between, the time is that of the step's end.
  const double end = t_ + h_;
  const bool follows = started_ && converged_ && std::abs(trial.t - end) <= 8.0 * epsilon * std::abs(end);
  previous_.known = follows;
  if (follows) {
    previous_.h = h_;
    dense(previous_.polynomial.data());
  }
  if (rate_ > keep_rate || !follows) jacobian_known_ = false;
  jacobian_here_ = false;
  started_ = true;
  t_ = trial.t;
  start_ = Eigen::Map<const Vector>(trial.x, n_);
}

Radau5::Outcome Radau5::solve(const RadauTrial& trial) {
  if (!jacobian_known_ && !differentiate(trial)) return Outcome::undefined;
  if (!factorize(trial.h)) return Outcome::undefined;
  start_values(trial.h);
  Outcome outcome = iterate(trial);
  if (outcome != Outcome::converged && (previous_.known || !jacobian_here_)) {
    // What came from earlier steps did not help: once more without it.
    if (!jacobian_here_ && !differentiate(trial)) return Outcome::undefined;
    if (!factorize(trial.h)) return Outcome::undefined;
    z_.setZero();
    w_.setZero();
    outcome = iterate(trial);
  }
  if (outcome != Outcome::undefined) return outcome;
  // The domain of f may move with t, and a state that stays behind be outside of it.
  for (Eigen::Index j = 0; j < 3; ++j) {
    z_.col(j) = Tableau::c[at(j)] * trial.h * Eigen::Map<const Vector>(trial.slope, n_);
  }
  transform_start();
  return iterate(trial);
}

/// The polynomial of the step before, beyond its end; zero at a restart.
void Radau5::start_values(double h) {
  if (!previous_.known) {
    z_.setZero();
    w_.setZero();
    return;
  }
  const Eigen::Map<const Matrix> p(previous_.polynomial.data(), n_, 3);
  for (Eigen::Index j = 0; j < 3; ++j) {
    const double beyond = Tableau::c[at(j)] * (h / previous_.h);
    // The nested form from its end: x(t + h) - r (p1 - s (p2 + s p3)).
    const double s = 1.0 + beyond;
    z_.col(j) = beyond * (p.col(0) - s * (p.col(1) + s * p.col(2)));
  }
  transform_start();
}

void Radau5::transform_start() {
  for (Eigen::Index j = 0; j < 3; ++j) {
    const auto& row = Tableau::t_inverse[at(j)];
    w_.col(j) = row[0] * z_.col(0) + row[1] * z_.col(1) + row[2] * z_.col(2);
  }
}

bool Radau5::factorize(double h) {
  if (factors_.known && std::abs(h - factors_.h) <= same_length * std::abs(h)) return true;
  factors_.known = systems_.factorize({Tableau::gamma / h, std::complex<double>(Tableau::alpha, Tableau::beta) / h});
  factors_.h = h;
  return factors_.known;
}

/// Until the next correction would be a rounding, or corrections are rounding and no longer fall.
Radau5::Outcome Radau5::iterate(const RadauTrial& trial) {
  const double stagnation = std::clamp(1e-2 * trial.tolerances.rtol, 1e3 * epsilon, 1e-8);
  double previous = 0.0;
  rate_ = 0.0;
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    if (!stage_slopes(trial)) return Outcome::undefined;
    const double size = correct(trial);
    if (!std::isfinite(size)) return Outcome::undefined;
    if (size <= epsilon) return Outcome::converged;
    if (iteration > 0) {
      const double rate = size / previous;
      if (previous > half_digits) rate_ = std::max(rate_, rate);
      if (rate < 1.0 && size * rate <= epsilon * (1.0 - rate)) return Outcome::converged;
      if (rate > 0.5 && size <= stagnation) return Outcome::converged;
      if (rate >= 2.0 || (rate >= 1.0 && iteration > 2)) return Outcome::failed;
      if (rate > renew_rate && !jacobian_here_ && size > stagnation) return Outcome::failed;
    }
    previous = size;
  }
  return Outcome::failed;
}

bool Radau5::stage_slopes(const RadauTrial& trial) {
  for (Eigen::Index j = 0; j < 3; ++j) {
    argument_ = start_ + z_.col(j);
    const double t = trial.t + Tableau::c[at(j)] * trial.h;
    if (!evaluate(trial, t, argument_, slopes_.col(j).data())) return false;
  }
  return true;
}

/// One Newton correction (IV.8.4); returns its largest component relative to the size of the component.
double Radau5::correct(const RadauTrial& trial) {
  const double h = trial.h;
  const auto& inverse = Tableau::t_inverse;
  const std::complex<double> pair(Tableau::alpha, Tableau::beta);
  for (Eigen::Index i = 0; i < n_; ++i) {
    const double f[] = {slopes_(i, 0), slopes_(i, 1), slopes_(i, 2)};
    const auto mixed = [&](std::size_t row) {
      return inverse[row][0] * f[0] + inverse[row][1] * f[1] + inverse[row][2] * f[2];
    };
    right_[i] = mixed(0) - Tableau::gamma / h * w_(i, 0);
    complex_right_[i] = std::complex<double>(mixed(1) - (pair.real() * w_(i, 1) - pair.imag() * w_(i, 2)) / h,
                                             mixed(2) - (pair.imag() * w_(i, 1) + pair.real() * w_(i, 2)) / h);
  }
  systems_.solve(right_, solution_);
  systems_.solve(complex_right_, complex_solution_);
  const auto& t = Tableau::t;
  const double floor = natural_size(trial.tolerances);
  double largest = 0.0;
  for (Eigen::Index i = 0; i < n_; ++i) {
    const double w[] = {solution_[i], complex_solution_[i].real(), complex_solution_[i].imag()};
    double change = 0.0;
    double size = std::abs(start_[i]) + floor;
    for (Eigen::Index j = 0; j < 3; ++j) {
      const auto& row = t[at(j)];
      const double dz = row[0] * w[0] + row[1] * w[1] + row[2] * w[2];
      w_(i, j) += w[j];
      z_(i, j) += dz;
      change = std::max(change, std::abs(dz));
      size = std::max(size, std::abs(z_(i, j)));
      if (!std::isfinite(dz)) return std::numeric_limits<double>::infinity();
    }
    largest = std::max(largest, change / std::max(size, smallest_normal));
  }
  return largest;
}

/// Forward differences, each into the direction in which the solution goes: a domain that ends at the start is not
/// left.
bool Radau5::differentiate(const RadauTrial& trial) {
  largest_ = start_.cwiseAbs().maxCoeff();
  const auto either_way = [&](const std::vector<std::size_t>& columns) {
    return difference(trial, columns, +1.0) || difference(trial, columns, -1.0);
  };
  for (const auto& columns : systems_.groups()) {
    if (!either_way(columns)) return false;
  }
  for (Eigen::Index j = 0; !systems_.is_sparse() && j < n_; ++j) {
    one_column_.assign(1, static_cast<std::size_t>(j));
    if (!either_way(one_column_)) return false;
  }
  jacobian_known_ = jacobian_here_ = true;
  factors_.known = false;
  return true;
}

double Radau5::increment(const RadauTrial& trial, Eigen::Index column, double largest) const {
  const auto& tolerances = trial.tolerances;
  const double natural = half_digits * natural_size(tolerances);
  const double floor = tolerances.rtol > 0.0 ? std::min(tolerances.atol, natural) : tolerances.atol;
  const double reach = trial.h * trial.slope[column];
  double increment = std::max(half_digits * std::max(std::abs(start_[column]), std::abs(reach)), floor);
  if (!(increment >= smallest_normal)) increment = half_digits * (largest > 0.0 ? largest : 1.0);
  return std::copysign(increment, reach);
}

/// Columns that have no row in common, all at once.
bool Radau5::difference(const RadauTrial& trial, const std::vector<std::size_t>& columns, double direction) {
  argument_ = start_;
  for (const std::size_t column : columns) {
    const auto j = static_cast<Eigen::Index>(column);
    argument_[j] += direction * increment(trial, j, largest_);
  }
  if (!evaluate(trial, trial.t, argument_, difference_slope_.data())) return false;
  difference_slope_ -= Eigen::Map<const Vector>(trial.slope, n_);
  bool finite = true;
  for (const std::size_t column : columns) {
    const auto j = static_cast<Eigen::Index>(column);
    finite = systems_.set_column(j, difference_slope_, argument_[j] - start_[j]) && finite;
  }
  return finite;
}

/// The estimate (IV.8.19), largest component in units of its scale. Not filtered once more (IV.8.20) where it asks for
/// a rejection: that passes over fast transients, and an event engine has to see what happens in them.
double Radau5::estimate(const RadauTrial& trial, const double* x_new) {
  const auto& e = Tableau::error;
  for (Eigen::Index i = 0; i < n_; ++i) {
    right_[i] = trial.slope[i] + (e[0] * z_(i, 0) + e[1] * z_(i, 1) + e[2] * z_(i, 2)) / trial.h;
  }
  systems_.solve(right_, solution_);
  double largest = 0.0;
  for (Eigen::Index i = 0; i < n_; ++i) {
    const double ratio = std::abs(solution_[i]) / error_scale(trial.tolerances, trial.x[i], x_new[i]);
    if (std::isnan(ratio)) return std::numeric_limits<double>::infinity();
    largest = std::max(largest, ratio);
  }
  return largest;
}

bool Radau5::evaluate(const RadauTrial& trial, double t, const Vector& x, double* slope) {
  const auto n = static_cast<std::size_t>(n_);
  if (!all_finite(x.data(), n)) return false;
  trial.f(t, x.data(), slope);
  ++*evaluations_;
  return all_finite(slope, n);
}

void Radau5::dense(double* coefficients) const {
  constexpr double c1 = Tableau::c[0];
  constexpr double c2 = Tableau::c[1];
  Eigen::Map<Matrix> p(coefficients, n_, 3);
  for (Eigen::Index i = 0; i < n_; ++i) {
    const double end = z_(i, 2);
    const double first = (z_(i, 0) / c1 - end) / (1.0 - c1);
    const double second = (z_(i, 1) / c2 - end) / (1.0 - c2);
    p(i, 0) = end;
    p(i, 2) = (second - first) / (c2 - c1);
    p(i, 1) = first - c1 * p(i, 2);
  }
}

}  // namespace saltus::ode
