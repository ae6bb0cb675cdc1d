// Where a switch moves few states of many, only these are integrated anew behind it.
#pragma once

#include <cstddef>
#include <map>
#include <vector>

#include "saltus/evaluation/model_kernel.hpp"
#include "saltus/event_integrator/mode/mode_state.hpp"
#include "saltus/event_integrator/options.hpp"
#include "saltus/event_integrator/steps/local_field.hpp"
#include "saltus/event_integrator/steps/step_tolerances.hpp"
#include "saltus/ode/stepper.hpp"

namespace saltus::event_integrator {

/// LocalSteps keeps the step in which a surface is crossed, met or left. It integrates the states that the selection
/// moves, and as many around them as that changes by more than the tolerance. It does so from the switch to the end of
/// the step, along the dense output of the others, which stay on it. Where a selection moves nothing beside its own
/// rows that is exact, but for the error of the dense output. Source: docs/adr/0025-local-steps.md.
class LocalSteps {
 public:
  LocalSteps(const IntegrationOptions& options, const evaluation::ModelKernel& kernel,
             const StepTolerances& tolerances);

  /// Returns whether there are such steps of this system. Cost: the first call finds its structure.
  [[nodiscard]] bool applies();
  /// Evaluates the slope at a point in the states that a surface is made of.
  void renew_slope(int surface, double t, const double* x, const std::vector<double>& alpha,
                   std::vector<double>& slope) const;
  /// Returns the solution behind the switch of a surface at (t, x), a point of the step, in the mode behind: to the end
  /// of the step, or to where the error of the part allows. `error` is that of the step of all states. Null where most
  /// of the states would have to be integrated, or surfaces there that are slid on influence each other. Stays as it is
  /// until the next call. Cost: that of the part, and some operations for each state.
  [[nodiscard]] const ode::DenseStep* behind(int surface, double t, const std::vector<double>& x,
                                             const ode::DenseStep& step, double error, const ModeState& mode);
  /// Returns the length of the next step of all states, by the error of this one.
  [[nodiscard]] double next_length() const { return next_length_; }

 private:
  bool integrate(const std::vector<double>& x);
  [[nodiscard]] bool is_felt() const;

  ode::Method method_;
  const evaluation::ModelKernel& kernel_;
  const StepTolerances& tolerances_;
  bool wanted_;
  LocalField field_;
  std::map<std::size_t, ode::Stepper> steppers_;  ///< by number of states
  ode::DenseStep known_;                          ///< of all states
  ode::DenseStep part_;                           ///< of those that were integrated
  double next_length_ = 0.0;
  std::vector<double> start_, start_slope_;
};

}  // namespace saltus::event_integrator
