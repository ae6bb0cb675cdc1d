// The exact time of an event: the step is retaken until the event function is at rounding level.
#pragma once

#include <optional>
#include <vector>

#include "saltus/event_integrator/event_search.hpp"
#include "saltus/event_integrator/mode_field.hpp"
#include "saltus/ode/stepper.hpp"

namespace saltus::event_integrator {

/// A step start: everything a step from it needs.
struct StepStart {
  double t = 0.0;
  const double* x = nullptr;
  const double* slope = nullptr;  ///< f(t, x)
};

/// An event reached from a step start: x on the sliding surfaces of the mode, and all functions that vanish there.
struct Located {
  double t = 0.0;
  std::vector<double> x;
  std::vector<std::size_t> functions;  ///< the one located first, then those that vanish together with it
  std::vector<int> signs;              ///< of `functions` before the event
};

/// Corrects a hit found on the dense output of the step (start, h).
/// Newton in t with the slope of the interpolant, safeguarded by the bracket of signs seen; every iteration retakes the
/// step, so the order of the method is kept. Of several functions the earliest zero is located; those that vanish with
/// it to rounding are one event.
/// @return nullopt if the right-hand side is undefined up to the event (shorten the step).
[[nodiscard]] std::optional<Located> locate(ode::Stepper& stepper, ModeField& field, EventSearch& search,
                                            const ode::Tolerances& tolerances, const StepStart& start,
                                            const ode::DenseStep& dense, Hit hit);

}  // namespace saltus::event_integrator
