// Finds the surfaces that guards and contacts at rest keep at zero: dry friction in the direction of a wall at which a
// mass rests.
#pragma once

#include <vector>

#include "saltus/event_integrator/contact/contacts.hpp"
#include "saltus/event_integrator/decide/transition.hpp"
#include "saltus/event_integrator/jumps/holding.hpp"
#include "saltus/event_integrator/jumps/resting_surfaces.hpp"

namespace saltus::event_integrator {

/// Finds them at a point on the held guards, in the cells of the kernel. Not among them are kinks, and functions nested
/// in others or around them. The problem is a selection that changes what presses on several guards, or selections that
/// multiply each other in it: where they are left is then a question of all of them together. Cost: three projections
/// onto the guards and a few evaluations of f per surface at zero.
[[nodiscard]] RestingSurfaces find_resting_surfaces(const SwitchingContext& switching_context, Holding& holding,
                                                    double t, const std::vector<double>& alpha,
                                                    const std::vector<double>& x);

/// Adds what is 0 here and wherever else the contacts hold: the sign of a velocity, its abs(v). All that is left of
/// their values is roundings. Nothing depends on the selection of a kink; those of dry friction change the forces of
/// the contacts only. Cost: an evaluation of all functions; where one of them is 0, two projections and a few
/// evaluations of f.
void add_kept_by_contacts(const SwitchingContext& switching_context, Contacts& contacts, double t,
                          const std::vector<double>& alpha, const std::vector<double>& x, RestingSurfaces& resting);

}  // namespace saltus::event_integrator
