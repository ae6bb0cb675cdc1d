// Contacts at an instant: where their modes change. Each of these ends the run where nothing follows.
#pragma once

#include "saltus/event_integrator/instant/instant_context.hpp"

namespace saltus::event_integrator {

/// Finds the modes at a start; bodies that touch and approach collide at once. Returns false where the run ends.
bool begin_contacts(const InstantContext& c);
/// Does the same behind a jump of positions or velocities.
bool begin_contacts_anew(const InstantContext& c);
/// Returns whether what jumps here, a gap or the velocity of a belt, has made contacts begin anew. Their event is told.
bool contacts_jump(const InstantContext& c);
/// Ends the modes of all contacts whose jumps are due, at once; returns false where the run ends.
bool move_contacts(const InstantContext& c);
/// Returns whether the jumps of this time were none: a slip in a plane goes on as it was.
[[nodiscard]] bool only_slips_on(const InstantContext& c);
/// Returns whether the modes behind last; one whose own conditions clearly do not hold would never end.
bool contact_modes_hold(const InstantContext& c);
/// Moves the state off gaps that have been located beside those that are closed: no body is in another one.
void put_on_gaps(RunState& run, const Located& located);
/// Limits the errors of steps by slips in a plane that are slow among fast velocities.
void limit_beside_rest(RunState& run);

}  // namespace saltus::event_integrator
