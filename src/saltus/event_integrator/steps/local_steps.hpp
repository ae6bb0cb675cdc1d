// Where a switch moves few states of many, only these are integrated anew behind it.
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "saltus/evaluation/field_parts.hpp"
#include "saltus/evaluation/model_kernel.hpp"
#include "saltus/event_integrator/options.hpp"
#include "saltus/event_integrator/steps/step_tolerances.hpp"
#include "saltus/ode/stepper.hpp"

namespace saltus::event_integrator {

/// LocalSteps keeps the step in which a surface is crossed. It integrates the states that the selection moves, and as
/// many around them as that changes by more than the tolerance. It does so from the switch to the end of the step,
/// along the dense output of the others, which stay on it. Where a selection moves nothing beside its own rows that is
/// exact, but for the error of the dense output. Source: docs/adr/0025-local-steps.md.
class LocalSteps {
 public:
  LocalSteps(const IntegrationOptions& options, const evaluation::ModelKernel& kernel,
             const StepTolerances& tolerances);

  /// Finds the slope behind the surface from that before it; false where it is not known to be in few rows.
  [[nodiscard]] bool slope_behind(int surface, double t, const double* x, const evaluation::FieldConstants& behind,
                                  const std::vector<double>& before, std::vector<double>& slope);
  /// Returns the solution behind the surface, which is crossed in the region of `behind` at (t, x), a point of the
  /// step: to the end of that, or to where the error of the part allows. `error` is that of the step of all states.
  /// Null where most of the states would have to be integrated. Stays as it is until the next call. Cost: that of the
  /// part, and some operations for each state.
  [[nodiscard]] const ode::DenseStep* behind(int surface, double t, const std::vector<double>& x,
                                             const ode::DenseStep& step, double error,
                                             const evaluation::FieldConstants& behind);
  /// Returns the length of the next step of all states, by the error of this one.
  [[nodiscard]] double next_length() const { return next_length_; }

 private:
  using Part = evaluation::FieldParts::Part;
  bool integrate(const Part& part, const std::vector<double>& x, const evaluation::FieldConstants& constants);
  [[nodiscard]] bool is_felt(const Part& part) const;
  [[nodiscard]] const Part* part_of(int surface, int rings);

  ode::Method method_;
  const evaluation::ModelKernel& kernel_;
  const StepTolerances& tolerances_;
  bool applies_;
  std::optional<evaluation::FieldParts> parts_;   ///< from the first switch on
  std::map<std::size_t, ode::Stepper> steppers_;  ///< by number of states
  ode::DenseStep known_;                          ///< of all states
  ode::DenseStep part_;                           ///< of those that were integrated
  double next_length_ = 0.0;
  std::vector<double> x_, slope_;  ///< n_x, of which a part is used
  std::vector<double> start_, start_slope_;
};

}  // namespace saltus::event_integrator
