// The first mode.
#pragma once

#include <utility>
#include <vector>

#include "saltus/event_integrator/transition.hpp"

namespace saltus::event_integrator {

struct Start {
  Transition transition;
  std::vector<int> at_zero;  ///< surfaces the solution starts on
};

/// Decides the mode at the start by the same switching as at an event; `forced` modes override it.
/// psi within rounding of 0 counts as 0. A forced mode that contradicts the sign of psi, or does not continue the
/// solution, ends with no_admissible_mode.
[[nodiscard]] Start decide_start(const Surroundings& surroundings, double t, const double* x, double time_scale,
                                 const std::vector<std::pair<int, int>>& forced);

}  // namespace saltus::event_integrator
