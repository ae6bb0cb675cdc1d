// Sliding on a function that has a root of another one inside it (terminal sliding modes). The motion runs into the
// zero of that one in finite time, like a power of the time that is left. No field goes on beyond.
#pragma once

#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "saltus/event_integrator/approach/zero_approach.hpp"
#include "saltus/event_integrator/mode/field_rates.hpp"
#include "saltus/event_integrator/steps/step_tolerances.hpp"

namespace saltus::event_integrator {

/// NestedZeroApproach foresees when the inner functions of a mode get to zero: g goes like (T - t)^p.
class NestedZeroApproach {
 public:
  NestedZeroApproach(const evaluation::ModelKernel& kernel, const Position& here, EventSearch& search,
                     const StepTolerances& tolerances, ZeroApproach& zeros)
      : kernel_(kernel), here_(here), search_(search), tolerances_(tolerances), zeros_(zeros), rates_(kernel, here) {}

  /// Watches the mode that begins here for such functions; returns whether the one before had any.
  bool begin_mode();
  [[nodiscard]] bool watches() const { return !functions_.empty(); }
  /// Notes that a step of length h was accepted; the position is still at its begin.
  void accepted(double h);
  /// Lowers what errors of a step may be, as parts of those of the mode.
  void limit(ode::Tolerances& parts);
  /// Returns where functions that the motion runs into the zeros of get there before `until`, together with those that
  /// do within their accuracy.
  [[nodiscard]] std::optional<Located> ahead(double until);
  /// Returns when the mode began.
  [[nodiscard]] double since() const { return since_; }

 private:
  /// A function g inside ones that are slid on, which have a root of it: where |g / g'| was last seen to have halved.
  struct Approaching {
    int function = 0;
    std::vector<int> around;
    double t = 0.0;
    double ratio = std::numeric_limits<double>::infinity();
    double end = std::numeric_limits<double>::quiet_NaN();  ///< where g is 0, by what was seen until then
  };

  void find_values();
  [[nodiscard]] std::optional<double> end_of(Approaching& approaching);
  [[nodiscard]] std::optional<Located> at_zeros(double end, const std::vector<std::size_t>& reached);

  const evaluation::ModelKernel& kernel_;
  const Position& here_;
  EventSearch& search_;
  const StepTolerances& tolerances_;
  ZeroApproach& zeros_;
  FieldRates rates_;
  std::vector<Approaching> functions_;
  double since_ = 0.0;
  std::vector<double> last_slope_;  ///< a step before
  double last_step_ = 0.0;
  std::vector<double> values_;  ///< of event functions
};

}  // namespace saltus::event_integrator
