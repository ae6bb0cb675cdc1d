#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <vector>

#include "saltus/base/at.hpp"
#include "saltus/linalg/matrix.hpp"
#include "saltus/ode/explicit/nested_form_internal.hpp"
#include "saltus/ode/radau_internal.hpp"
#include "saltus/ode/radau_iteration_internal.hpp"
#include "saltus/ode/radau_steps_internal.hpp"
#include "saltus/ode/radau_tableau.hpp"
#include "saltus/ode/step_checks_internal.hpp"

namespace saltus::ode {

template <class Tableau>
RadauSteps<Tableau>::RadauSteps(int n)
    : n_(n),
      start_(n),
      previous_{false, 0.0, std::vector<double>(stages * static_cast<std::size_t>(n))},
      systems_(n),
      one_column_(1),
      z_(n, last + 1),
      w_(n, last + 1),
      slopes_(n, last + 1),
      corrections_(n, last + 1),
      work_(n) {}

template <class Tableau>
void RadauSteps<Tableau>::restart() {
  started_ = previous_.known = jacobian_known_ = factors_.known = false;
  outcome_ = Stages::undefined;
  failures_ = 0;
  rate_ = 0.0;
}

template <class Tableau>
Attempt RadauSteps<Tableau>::attempt(const RadauTrial& trial, double* x_new, double* slope_new, long& evaluations) {
  evaluations_ = &evaluations;
  if (systems_.use(trial.pattern)) jacobian_known_ = factors_.known = false;
  begin(trial);
  h_ = trial.h;
  outcome_ = solve(trial);
  if (outcome_ != Stages::found) return Attempt::undefined;
  for (linalg::Index i = 0; i < n_; ++i) x_new[i] = trial.x[i] + z_(i, last);
  if (!all_finite(x_new, static_cast<std::size_t>(n_))) {
    outcome_ = Stages::undefined;
    return Attempt::undefined;
  }
  error_norm_ = estimate(trial, x_new);
  work_.argument = linalg::ConstView(x_new, n_);
  return evaluate(trial, trial.t + trial.h, work_.argument, slope_new) ? Attempt::finite : Attempt::undefined;
}

/// Tells a retaken step from a new one, which may continue the polynomial of the last.
template <class Tableau>
void RadauSteps<Tableau>::begin(const RadauTrial& trial) {
  const bool retaken = started_ && trial.t == t_ && std::equal(trial.x, trial.x + n_, start_.data());
  if (retaken) return;
  // NOTE: the state may have been projected onto a sliding surface in between, the time is that of the step's end.
  const double end = t_ + h_;
  const bool follows =
      started_ && outcome_ == Stages::found && std::abs(trial.t - end) <= 8.0 * radau_epsilon * std::abs(end);
  previous_.known = follows;
  if (follows) {
    previous_.h = h_;
    dense(previous_.polynomial.data());
  }
  if (rate_ > keep_rate || !follows) jacobian_known_ = false;
  jacobian_here_ = false;
  if (failures_ < most_failures) failures_ = 0;
  started_ = true;
  t_ = trial.t;
  start_ = linalg::ConstView(trial.x, n_);
}

template <class Tableau>
auto RadauSteps<Tableau>::solve(const RadauTrial& trial) -> Stages {
  if (!jacobian_known_ && !differentiate(trial)) return Stages::no_jacobian;
  if (!factorize(trial.h)) return Stages::singular;
  start_values(trial.h);
  Stages outcome = iterate(trial);
  if (outcome != Stages::found && (previous_.known || !jacobian_here_)) {
    // What came from earlier steps did not help: once more without it.
    if (!jacobian_here_ && !differentiate(trial)) return Stages::no_jacobian;
    if (!factorize(trial.h)) return Stages::singular;
    z_.set_zero();
    w_.set_zero();
    outcome = iterate(trial);
  }
  if (outcome == Stages::not_found && trial.jacobian != nullptr && ++failures_ == most_failures) {
    // Differences see nothing of what changes within the rounding of a state.
    if (!differentiate(trial)) return Stages::no_jacobian;
    if (!factorize(trial.h)) return Stages::singular;
    z_.set_zero();
    w_.set_zero();
    outcome = iterate(trial);
  }
  if (outcome == Stages::found) return outcome;
  // The domain of f may move with t, or what it is steep in, and a state that stays behind be outside of it.
  for (linalg::Index j = 0; j <= last; ++j) {
    for (linalg::Index i = 0; i < n_; ++i) z_(i, j) = Tableau::c[at(j)] * trial.h * trial.slope[i];
  }
  transform_start();
  return iterate(trial);
}

/// The polynomial of the step before, beyond its end; zero at a restart.
template <class Tableau>
void RadauSteps<Tableau>::start_values(double h) {
  if (!previous_.known) {
    z_.set_zero();
    w_.set_zero();
    return;
  }
  const linalg::ConstView p(previous_.polynomial.data(), n_, last + 1);
  for (linalg::Index j = 0; j <= last; ++j) {
    const double beyond = Tableau::c[at(j)] * (h / previous_.h);
    // The nested form from its end: x(t + h) - r (p1 - s (p2 + s (p3 + r (p4 + s (p5 + ...))))), r = -beyond.
    const double s = 1.0 + beyond;
    linalg::View column = z_.col(j);
    column = p.col(last);
    for (linalg::Index k = last - 1; k >= 1; --k) {
      column *= k % 2 == 1 ? s : -beyond;
      column += p.col(k);
    }
    column *= -s;
    column += p.col(0);
    column *= beyond;
  }
  transform_start();
}

template <class Tableau>
void RadauSteps<Tableau>::transform_start() {
  for (linalg::Index j = 0; j <= last; ++j) {
    const auto& row = Tableau::t_inverse[at(j)];
    linalg::View column = w_.col(j);
    column.set_zero();
    for (linalg::Index k = 0; k <= last; ++k) column.add_scaled(row[at(k)], z_.col(k));
  }
}

template <class Tableau>
bool RadauSteps<Tableau>::factorize(double h) {
  if (factors_.known && std::abs(h - factors_.h) <= same_length * std::abs(h)) return true;
  std::array<std::complex<double>, stages / 2> pairs;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    pairs[k] = std::complex<double>(Tableau::pairs[k].alpha, Tableau::pairs[k].beta) / h;
  }
  factors_.known = systems_.factorize({Tableau::gamma / h, pairs});
  factors_.h = h;
  return factors_.known;
}

/// The estimate (IV.8.19), largest component in units of its scale. Not filtered once more (IV.8.20) where it asks for
/// a rejection: that passes over fast transients, and an event engine has to see what happens in them.
template <class Tableau>
double RadauSteps<Tableau>::estimate(const RadauTrial& trial, const double* x_new) {
  const auto& e = Tableau::error;
  for (linalg::Index i = 0; i < n_; ++i) {
    double sum = e[0] * z_(i, 0);
    for (std::size_t j = 1; j < stages; ++j) sum += e[j] * z_(i, static_cast<linalg::Index>(j));
    work_.right[i] = trial.slope[i] + sum / trial.h;
  }
  systems_.solve(work_.right, work_.solution);
  double largest = 0.0;
  for (linalg::Index i = 0; i < n_; ++i) {
    const double ratio = std::abs(work_.solution[i]) / error_scale(trial.tolerances, trial.x[i], x_new[i]);
    if (std::isnan(ratio)) return std::numeric_limits<double>::infinity();
    largest = std::max(largest, ratio);
  }
  return largest;
}

template <class Tableau>
bool RadauSteps<Tableau>::evaluate(const RadauTrial& trial, double t, const Vector& x, double* slope) {
  const auto n = static_cast<std::size_t>(n_);
  if (!all_finite(x.data(), n)) return false;
  trial.f(t, x.data(), slope);
  ++*evaluations_;
  return all_finite(slope, n);
}

template <class Tableau>
double RadauSteps<Tableau>::spectral_radius() {
  if (!jacobian_known_) return std::numeric_limits<double>::infinity();
  if (work_.direction.size() != n_) {
    // No vector of a model: all components, of both signs and several sizes.
    constexpr linalg::Index sizes = 7;
    work_.direction.resize(n_);
    for (linalg::Index i = 0; i < n_; ++i)
      work_.direction[i] = (i % 2 == 0 ? 1.0 : -1.0) / static_cast<double>(1 + i % sizes);
  }
  double radius = 0.0;
  for (int product = 0; product < 2; ++product) {
    const double size = work_.direction.norm();
    systems_.multiply(work_.direction, work_.solution);
    const double grown = work_.solution.norm();
    if (!(grown > 0.0) || !std::isfinite(grown)) return grown;
    radius = grown / size;
    for (linalg::Index i = 0; i < n_; ++i) work_.direction[i] = work_.solution[i] / grown;
  }
  return radius;
}

/// By divided differences of (z(theta) / theta - z(1)) / (1 - theta), whose Newton form with the nodes c is then
/// written with the nodes 0, 1, 0, ... of the nested form: a node at a time, the last one first.
template <class Tableau>
void RadauSteps<Tableau>::dense(double* coefficients) const {
  constexpr auto& c = Tableau::c;
  constexpr std::size_t inner = stages - 1;
  struct Differences {  ///< of one state: the coefficients behind the first one
    double* p;
    std::size_t n;
    double& operator[](std::size_t k) { return p[(k + 1) * n]; }
  };
  const auto n = static_cast<std::size_t>(n_);
  for (linalg::Index i = 0; i < n_; ++i) {
    Differences d{coefficients + i, n};
    coefficients[i] = z_(i, last);
    for (std::size_t k = 0; k < inner; ++k) d[k] = (z_(i, index(k)) / c[k] - z_(i, last)) / (1.0 - c[k]);
    for (std::size_t distance = 1; distance < inner; ++distance) {
      for (std::size_t k = inner - 1; k >= distance; --k) d[k] = (d[k] - d[k - 1]) / (c[k] - c[k - distance]);
    }
    std::array<double, inner - 1> nodes;
    std::copy_n(c.begin(), inner - 1, nodes.begin());
    for (std::size_t next = inner - 1; next-- > 0;) begin_with_node(next % 2 == 0 ? 0.0 : 1.0, d, nodes);
    for (std::size_t k = 0; k < inner; ++k) {
      if (sign_of_nested(k) < 0.0) d[k] = -d[k];
    }
  }
}

std::unique_ptr<Radau> make_radau(Method method, int n) {
  switch (method) {
    case Method::radau5:
      return std::make_unique<RadauSteps<Radau5Tableau>>(n);
    case Method::radau9:
      return std::make_unique<RadauSteps<Radau9Tableau>>(n);
    case Method::radau13:
      return std::make_unique<RadauSteps<Radau13Tableau>>(n);
    case Method::dopri5:
    case Method::dop853:
    case Method::taylor:
      return nullptr;
  }
  __builtin_unreachable();
}

}  // namespace saltus::ode
