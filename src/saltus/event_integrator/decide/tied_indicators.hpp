// Regions whose indicators are equal where a switch is.
#pragma once

#include <optional>
#include <utility>

#include "saltus/evaluation/model_kernel.hpp"
#include "saltus/event_integrator/decide/transition.hpp"
#include "saltus/event_integrator/mode/mode_state.hpp"

namespace saltus::event_integrator {

/// Notes the regions of one group that are at its minimum where a switching point is: those at zero, and their
/// references.
void note_ties(const evaluation::ModelKernel& kernel, const ModeState& before, SwitchingPoint& switching_point);

/// Finds two of the regions at the minimum (`tied`) whose indicators are one and the same function, near by and as time
/// goes, too: nothing says which of them is active.
[[nodiscard]] std::optional<std::pair<int, int>> same_indicators(const evaluation::ModelKernel& kernel,
                                                                 const ModeState& state,
                                                                 const SwitchingPoint& switching_point);

/// Adds to those at zero of a group the regions that are so to rounding of psi or of the time: where several reach the
/// minimum within a few roundings, as at the end of a spiral, which one is located there means nothing.
void complete_ties(const evaluation::ModelKernel& kernel, const ModeState& before, SwitchingPoint& switching_point);

}  // namespace saltus::event_integrator
