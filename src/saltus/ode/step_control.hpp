// Step size selection.
#pragma once

#include <optional>

#include "saltus/ode/stepper.hpp"

namespace saltus::ode {

/// Controls the length of steps: a value, one per run; reset at every restart. dopri5 has a PI controller (Gustafsson;
/// Hairer & Wanner IV.2). dop853 and radau5 have no memory of errors. Once a step was rejected, dop853 foresees that
/// the error per step goes on growing as it did.
class StepControl {
 public:
  explicit StepControl(Method method);
  /// Says what the steps are made by from here on: of Method::taylor either of its two ways.
  void follow(Method method) { method_ = method; }
  /// Returns the factor h_new / h after an accepted step with this error norm (<= 1). At most 1 right after a
  /// rejection.
  [[nodiscard]] double accepted(double error_norm);
  /// Returns the factor (< 1) after a rejected step (error norm > 1, infinity included).
  [[nodiscard]] double rejected(double error_norm);
  void reset();
  /// Begins behind an event, where the length of the next step is one that was right for such a step before: its error
  /// is taken for that of the step before it, too, as in a row of like steps. As at a start (reset) dopri5 would
  /// shorten the step behind it by 0.7, and from then on the first one of every mode that comes back.
  void restart();

 private:
  [[nodiscard]] double factor(double error_norm);
  [[nodiscard]] double growth(double error_norm);

  Method method_;
  std::optional<double> previous_logarithm_;  ///< of the error of the step before; nullopt: that of the next one
  double previous_root_ = 0.0;                ///< dop853, radau9, radau13: that error to their power, 0 = none
  double change_ = 1.0;                       ///< of the step since
  bool any_rejected_ = false;
  bool last_rejected_ = false;
};

/// Tells whether stability limits the accepted steps of an explicit method: 15 suspicious ones, and not six others in a
/// row between them (codes DOPRI5 and DOP853 of Hairer & Wanner; here one step of 16 is looked at while there is no
/// suspicion). Suspicious are steps longer than 0.65 of what is stable, and shorter ones that change the state by less
/// than its tolerance.
class StiffnessWatch {
 public:
  /// Is asked after every accepted step; true once, when the suspicion is enough.
  [[nodiscard]] bool looks_stiff(const Stepper& stepper, const Tolerances& tolerances);
  /// Begins with a new right-hand side.
  void reset() { *this = StiffnessWatch{}; }

 private:
  long steps_ = 0;
  int suspicions_ = 0;
  int innocent_ = 0;
};

/// Returns the first step size, signed like `span` and at most as long (Hairer, Norsett & Wanner, II.4, algorithm
/// 4.14). It follows from the sizes of x, of its slope and of the change of the slope along an explicit Euler step.
///
/// Here the unit of time, which is 1 in that algorithm, is the time in which x would change by its own size (|span|
/// where x is negligible): scaling t and span, or x and atol, scales the result (exactly for powers of two).
///
/// @param x      state, n doubles
/// @param slope  f(t, x), n doubles; slopes that are 0 and stay 0 give a small fraction of the span
/// @param span   signed length of the interval of integration, not 0
/// Cost: one evaluation of f; where f is undefined behind the Euler step, it is shortened and evaluated again.
/// Allocates: meant for starts and restarts.
[[nodiscard]] double initial_step(Method method, RightHandSide f, double t, const double* x, const double* slope, int n,
                                  double span, const Tolerances& tolerances);

}  // namespace saltus::ode
