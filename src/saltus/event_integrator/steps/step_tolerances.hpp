// The tolerances of a step: those of the run, lowered by the mode and by what is near.
#pragma once

#include <array>
#include <cstddef>

#include "saltus/evaluation/model_kernel.hpp"
#include "saltus/event_integrator/mode/position.hpp"
#include "saltus/event_integrator/mode/resolution.hpp"
#include "saltus/event_integrator/options.hpp"

namespace saltus::event_integrator {

/// StepTolerances is the one budget of errors. A mode may lower what the run asks for, and each reason leaves a part
/// of that: step = mode * product of the parts.
class StepTolerances {
 public:
  enum class Reason {
    coalescence,  ///< the root of sliding selections is near another one
    cycles,       ///< cycles of switches contract
    zeros,        ///< a function of which the field has a root is near zero
    slips,        ///< a slip in a plane is slower than what it is the difference of
    local,        ///< switches are located on the dense output, and states go on from there (LocalSteps)
  };

  explicit StepTolerances(const ode::Tolerances& wanted);

  [[nodiscard]] const ode::Tolerances& step() const { return step_; }
  [[nodiscard]] const ode::Tolerances& mode() const { return mode_; }
  /// Begins a mode here, maybe inside of layers. Roots of the mode before are none of it.
  void begin_mode(const evaluation::ModelKernel& kernel, const ThinLayers& layers, const Position& here);
  /// Limits what a reason leaves from now on to these parts, in (0, 1].
  void limit(Reason reason, const ode::Tolerances& parts);
  void lift(Reason reason) { limit(reason, unlimited); }
  [[nodiscard]] const ode::Tolerances& part(Reason reason) const { return parts_[static_cast<std::size_t>(reason)]; }
  /// Returns the part of rtol that doubles carry of a state, several hundred times.
  [[nodiscard]] double smallest_part() const { return carried_part / mode_.rtol; }

 private:
  static constexpr ode::Tolerances unlimited{1.0, 1.0};
  ode::Tolerances wanted_, mode_, step_;
  std::array<ode::Tolerances, 5> parts_{unlimited, unlimited, unlimited, unlimited, unlimited};  ///< by reason
};

}  // namespace saltus::event_integrator
