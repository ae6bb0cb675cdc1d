// Switching at an instant: the surfaces that are at zero, and the mode behind them.
#pragma once

#include "saltus/event_integrator/decide/fast/single_surface.hpp"
#include "saltus/event_integrator/decide/fast/surface_pair.hpp"
#include "saltus/event_integrator/instant/instant_context.hpp"

namespace saltus::event_integrator {

/// Fills the switching point of the outcome with the surfaces that are at zero here, and why. Returns false where the
/// run ends: a nested function reaches 0 on one side only of a surface that is slid on.
/// @param longest_step  since the last event: towards a root that is lost steps shrink to nothing, over which no field
///                      changes
bool collect_surfaces(const InstantContext& c, const Located& located, double longest_step);

/// Adds the surfaces that are touched by what happens to others here: freed by a guard, or moved into another cell.
/// Returns the mode to decide from.
const ModeState& touch_others(const InstantContext& c);

/// Decides the mode behind the surfaces that are touched, into the transition of the outcome: by one surface, by two,
/// or by all that are at zero.
void decide_touched(const InstantContext& c, const ModeState& from, SingleSurface& single, SurfacePair& pair);

}  // namespace saltus::event_integrator
