// The first mode.
#pragma once

#include <utility>
#include <vector>

#include "saltus/event_integrator/decide/transition.hpp"
#include "saltus/event_integrator/jumps/resting_surfaces.hpp"

namespace saltus::event_integrator {

struct Start {
  Transition transition;
  std::vector<int> at_zero;  ///< surfaces the solution starts on
};

/// Decides the mode at the start by the same switching as at an event; `forced` modes override it.
/// psi within rounding of 0 counts as 0. A forced mode that contradicts the sign of psi, or does not continue the
/// solution, ends with no_admissible_mode. Surfaces of `resting` are not decided.
[[nodiscard]] Start decide_start(const SwitchingContext& switching_context, double t, const double* x,
                                 double time_scale, const std::vector<std::pair<int, int>>& forced,
                                 const RestingSurfaces& resting);

/// Decides the mode behind a jump of the model or of the state at (t, x): as at a start, but surfaces of `held`
/// (located here, or sliding, and still at zero) are at zero whatever is left of their psi. Those of `slid`, whose psi
/// may have jumped, are where no more than a few roundings are left. Those of `resting` are not decided.
[[nodiscard]] Transition decide_behind_jump(const SwitchingContext& switching_context, const ModeState& before,
                                            double t, const double* x, double time_scale, const std::vector<int>& held,
                                            const RestingSurfaces& resting = {}, const std::vector<int>& slid = {});

}  // namespace saltus::event_integrator
