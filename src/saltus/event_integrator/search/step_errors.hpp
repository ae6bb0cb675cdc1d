// What the errors of steps leave of event functions.
#pragma once

#include <vector>

#include "saltus/evaluation/model_kernel.hpp"
#include "saltus/event_integrator/search/affine_forms.hpp"
#include "saltus/ode/stepper.hpp"

namespace saltus::event_integrator {

/// StepErrors knows the tolerances that steps are taken with, and what follows from them for functions of the state.
class StepErrors {
 public:
  /// @param tolerances  those of the steps, whatever they are when a step is taken
  StepErrors(const evaluation::ModelKernel& kernel, const ode::Tolerances& tolerances)
      : kernel_(kernel), run_(tolerances), now_(tolerances), gradient_(static_cast<std::size_t>(kernel.states())) {}

  /// Returns the tolerances of the run, before anything lowers them.
  [[nodiscard]] const ode::Tolerances& of_run() const { return run_; }
  /// Returns what the errors of a step may have changed an event function by, as far as its gradient at (t, x) says:
  /// 0 where that is not finite, and for functions of time. Cost: a gradient.
  /// @param bounds  of the states over the step
  [[nodiscard]] double of(int function, double t, const double* x, const double* alpha, const StepBounds& bounds);

 private:
  const evaluation::ModelKernel& kernel_;
  ode::Tolerances run_;
  const ode::Tolerances& now_;
  std::vector<double> gradient_;
};

}  // namespace saltus::event_integrator
