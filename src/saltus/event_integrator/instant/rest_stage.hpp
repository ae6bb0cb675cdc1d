// Guards of jumps at rest at an instant: which are held and released, and which surfaces they keep at zero.
#pragma once

#include <vector>

#include "saltus/event_integrator/instant/instant_context.hpp"
#include "saltus/event_integrator/jumps/resting_surfaces.hpp"

namespace saltus::event_integrator {

/// Finds the surfaces that held guards and contacts keep at zero; returns false if these cannot be followed, where the
/// run ends.
bool find_resting(const InstantContext& c, RestingSurfaces& resting);
/// Holds the guards that come to rest behind jumps. Returns whether the field has changed.
bool hold_resting(const InstantContext& c);
/// Puts the state on guards and keeps it there; returns false if that fails, where the run ends.
bool hold_guards(const InstantContext& c, std::vector<HeldGuard> guards, std::vector<HeldGuard> loose);
/// Frees guards at a limit whose jumps let a motion go on: the state is at rest on them, and what slides, if anything,
/// keeps it there. Returns false if the others cannot be held, where the run ends.
bool free_passing(const InstantContext& c);
/// Frees held guards on which nothing presses any more, and the surfaces that they have kept at zero; returns whether
/// there were any.
bool release(const InstantContext& c, const Located& located);
/// Returns whether in the cells that were entered the guards at rest keep other surfaces at zero than before: friction
/// on a belt that comes to rest, or starts.
bool change_resting_with_cells(const InstantContext& c);
/// Frees guards at rest where a jump of values has moved their zero, or a contact, away from the state: a table that
/// drops, a belt that gets another speed. They are on the side where they are then; contacts begin anew. Returns
/// whether it has.
bool leaves_resting_with_cells(const InstantContext& c);
/// Makes of the mode before one that slides on the surfaces that a released guard has kept at zero. The motion leaves
/// them where it would if it had slid on them. It goes to the side with whose selection nothing presses on the guard
/// any more.
const ModeState& slid_on_freed(const InstantContext& c);

}  // namespace saltus::event_integrator
