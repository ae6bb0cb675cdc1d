// Step size selection.
#pragma once

#include "saltus/ode/stepper.hpp"

namespace saltus::ode {

/// PI controller (Gustafsson; Hairer, Norsett & Wanner IV.2): a value, one per run; reset at every restart.
class StepControl {
 public:
  explicit StepControl(Method method);
  /// Factor h_new / h after an accepted step with this error norm (<= 1).
  [[nodiscard]] double accepted(double error_norm);
  /// Factor (< 1) after a rejected step (error norm > 1).
  [[nodiscard]] double rejected(double error_norm);
  void reset();

 private:
  Method method_;
  double previous_error_ = 1e-4;
  bool last_rejected_ = false;
};

/// First step size (Hairer, Norsett & Wanner, II.4), signed like `direction`, at most |span|. One evaluation of f.
/// Independent of the scaling of t up to rounding; 0 slopes give a fraction of the span.
[[nodiscard]] double initial_step(Method method, RightHandSide f, double t, const double* x, const double* slope, int n,
                                  double span, const Tolerances& tolerances);

}  // namespace saltus::ode
