// The other admissible modes at a point where the solution is not unique, and modes that a user prefers there.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "saltus/event_integrator/decide/transition.hpp"

namespace saltus::event_integrator {

/// Decides the mode behind a switching point with the modes of some surfaces at zero given and the rest decided for
/// them.
/// @return nullopt if it does not continue the solution: the rest has no mode, or one of the given ones does not move
///         to where it says.
[[nodiscard]] std::optional<Transition> decide_with(const SwitchingContext& switching_context, const ModeState& before,
                                                    const SwitchingPoint& switching_point,
                                                    const std::vector<GivenMode>& given);

/// Fills `alternatives` from `other_choices`: every other choice with the rest decided for it; those that are
/// admissible, each once.
void other_continuations(const SwitchingContext& switching_context, const ModeState& before,
                         const SwitchingPoint& switching_point, Transition& transition);

/// Returns the transition to one of the alternatives; what was decided is the first among its alternatives then.
/// @param alternative  below the number of decided.alternatives
[[nodiscard]] Transition alternative_of(Transition decided, std::size_t alternative);

}  // namespace saltus::event_integrator
