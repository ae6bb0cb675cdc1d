#include "saltus/event_integrator/steps/step_attempt.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace saltus::event_integrator {

StepAttempt::StepAttempt(const IntegrationOptions& options, const model::Layout& layout, ModeField& field,
                         const Position& here, const StepTolerances& tolerances)
    : options_(options),
      field_(field),
      here_(here),
      tolerances_(tolerances),
      method_(options.method),
      stepper_(options.method, static_cast<int>(here.x.size())),
      control_(options.method),
      choice_(options, here),
      x_(here.x.size()),
      slope_(x_.size()),
      dense_slope_(x_.size()) {
  for (std::size_t i = 0; i < x_.size(); ++i) {
    if (i >= layout.discrete_states.size() || !layout.discrete_states[i]) continuous_.push_back(i);
  }
  if (!continuous_.empty()) {
    error_share_ = std::sqrt(static_cast<double>(x_.size()) / static_cast<double>(continuous_.size()));
  }
}

ode::Attempt StepAttempt::take(double t_new) {
  dense_is_last_ = false;
  return field_.attempt(stepper_, here_.t, here_.x.data(), here_.slope.data(), t_new - here_.t, tolerances_.step());
}

void StepAttempt::use(ode::Method method) {
  if (method == method_) return;
  method_ = method;
  stepper_ = ode::Stepper(method, static_cast<int>(x_.size()));
  control_ = ode::StepControl(method);
}

bool StepAttempt::remake_dense() {
  known_ = stepper_.followed();
  return known_ != nullptr || stepper_.dense(right_hand_side(), dense_) == ode::Attempt::finite;
}

/// h |f - dx/dt| of the dense output in the middle of the last attempt, in units of the local tolerance; 0 where that
/// is not defined. The error of the step is about the integral of f - dx/dt over it.
double StepAttempt::defect() {
  if (!make_dense()) return 0.0;
  constexpr double middle = 0.5;
  dense_.evaluate(middle, x_.data());
  dense_.derivative(middle, dense_slope_.data());
  field_(dense_.t + middle * dense_.h, x_.data(), slope_.data());
  double largest = 0.0;
  for (const std::size_t i : continuous_) {
    const double size = std::max(std::abs(here_.x[i]), std::abs(stepper_.x_new()[i]));
    const auto& [rtol, atol] = tolerances_.step();
    const double tolerance = std::max(atol + rtol * size, std::numeric_limits<double>::min());
    const double part = std::abs(dense_.h * (slope_[i] - dense_slope_[i])) / tolerance;
    if (std::isfinite(part)) largest = std::max(largest, part);
  }
  return largest;
}

/// Whether the last attempt is far longer than the step before it in its mode. The estimate of that one must have been
/// far below the tolerance: one that passes through zero there may do so again.
bool StepAttempt::leaps() const {
  constexpr double far = 1.5;
  return last_ > 0.0 && stepper_.length() > far * last_;
}

/// The first step of a new mode has the length that was right for another field, or a fifth of it, and so on: of very
/// many such lengths, far too long ones, some have an estimate that passes through zero. Of 33 000 steps of random
/// systems that were long enough for their estimate to matter 999 of 1000 had a defect below 55; steps that were wrong
/// by 12 to 700 had 52 to 50 000.
double StepAttempt::confirmed_error() {
  const double error = error_norm();
  // The dense output of the other ones is the method; all terms of a series that are neglected follow from the last.
  if (stepper_.follows()) return error;
  last_error_ = error;
  const bool has_estimate = !ode::is_implicit(stepper_.method()) && stepper_.method() != ode::Method::taylor;
  if (!(error <= 1.0) || !has_estimate || !(memory_.is_guess() || leaps())) return error;
  constexpr double believed = 25.0;
  return std::max(error, defect() / believed);
}

void StepAttempt::accepted(double h) {
  longest_ = std::max(longest_, h);
  last_ = h;
}

void StepAttempt::begin_mode() {
  stepper_.restart();
  choice_.begin_mode();
}

void StepAttempt::restart_control(Steps steps) {
  longest_ = last_ = 0.0;
  if (steps == Steps::may_repeat) {
    control_.restart();
  } else {
    control_.reset();
  }
}

double StepAttempt::initial_step() {
  const auto step_from = [&](ode::RightHandSide f, const double* x, const double* slope) {
    return ode::initial_step(options_.method, f, here_.t, x, slope, static_cast<int>(continuous_.size()),
                             options_.until - options_.from, tolerances_.step());
  };
  control_.reset();
  if (continuous_.size() == x_.size()) return step_from(right_hand_side(), here_.x.data(), here_.slope.data());
  const auto select = [&](const std::vector<double>& all) {
    std::vector<double> selected;
    for (const auto i : continuous_) selected.push_back(all[i]);
    return selected;
  };
  std::vector<double> point = here_.x;
  std::vector<double> rate(x_.size());
  const auto right_hand_side_of_continuous = [&](double t, const double* x, double* xdot) {
    for (std::size_t k = 0; k < continuous_.size(); ++k) point[continuous_[k]] = x[k];
    field_(t, point.data(), rate.data());
    for (std::size_t k = 0; k < continuous_.size(); ++k) xdot[k] = rate[continuous_[k]];
  };
  return step_from(right_hand_side_of_continuous, select(here_.x).data(), select(here_.slope).data());
}

}  // namespace saltus::event_integrator
