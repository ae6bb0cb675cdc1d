// Surfaces that guards or contacts at rest keep at zero: dry friction in the direction of a wall at which a mass rests.
#pragma once

#include <string>
#include <vector>

namespace saltus::event_integrator {

/// Holds surfaces whose psi vanishes wherever the held guards, or contacts, are at rest, and whose selections move
/// nothing there: what they take of the force that presses on a guard is not determined, the motion is.
struct RestingSurfaces {
  std::vector<int> surfaces;  ///< ascending
  /// Selections with which most presses on the guards: a guard is left where nothing does with these.
  std::vector<double> alpha;
  std::string problem;  ///< why they cannot be followed; empty if they can
};

}  // namespace saltus::event_integrator
