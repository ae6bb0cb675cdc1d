// Surfaces that guards at rest keep at zero: dry friction in the direction of a wall at which a mass rests.
#pragma once

#include <string>
#include <vector>

#include "saltus/event_integrator/holding.hpp"
#include "saltus/event_integrator/transition.hpp"

namespace saltus::event_integrator {

/// Surfaces whose psi vanishes wherever the held guards are at rest, and whose selections move nothing there: what they
/// take of the force that presses on a guard is not determined, the motion is.
struct RestingSurfaces {
  std::vector<int> surfaces;  ///< ascending
  /// Selections with which most presses on the guards: a guard is left where nothing does with these.
  std::vector<double> alpha;
  std::string problem;  ///< why they cannot be followed; empty if they can
};

/// At a point on the held guards, in the cells of the kernel. Not among them are kinks, and functions nested in others
/// or around them. The problem is a selection that changes what presses on several guards, or selections that multiply
/// each other in it: where they are left is then a question of all of them together.
/// Cost: three projections onto the guards and a few evaluations of f per surface at zero.
[[nodiscard]] RestingSurfaces find_resting_surfaces(const Surroundings& surroundings, Holding& holding, double t,
                                                    const std::vector<double>& alpha, const std::vector<double>& x);

}  // namespace saltus::event_integrator
