// Finds the surfaces that guards at rest keep at zero: dry friction in the direction of a wall at which a mass rests.
#pragma once

#include <vector>

#include "saltus/base/function_ref.hpp"
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

/// Puts a point on what is held.
using Projection = FunctionRef<void(double t, std::vector<double>& x)>;

/// Adds the kinks that are 0 here and wherever else `project` leads: abs(v) of a velocity that a contact holds. Nothing
/// depends on their selections, and all that is left of their values is roundings. Cost: an evaluation of all
/// functions, and two projections where one of them is a kink at 0.
void add_kept_kinks(const SwitchingContext& switching_context, const Projection& project, double t,
                    const std::vector<double>& alpha, const std::vector<double>& x, RestingSurfaces& resting);

}  // namespace saltus::event_integrator
