// Results of the regularised system in the words of the original one.
#pragma once

#include <vector>

#include "saltus/result/result.hpp"

namespace saltus::smoothed {

struct Regularisation;

/// Rewrites what a simulation of regularisation.system computed:
///   mode_j = -1, 0, 1 for psi_j < -epsilon, inside the layer |psi_j| <= epsilon, psi_j > epsilon;
///   alpha_j = (1 + pi(psi_j / epsilon)) / 2.
/// Regions by `indicator` are active from a weight of about 1e-6 on (weight_range).
/// Passing an edge of a layer is an event (enter_sliding, leave_sliding) with the surface's name; a crossing is hence
/// two of them. Edges that change no mode (of a nested function on a side the solution is not on) leave no event.
/// A status that speaks of switching says that a layer of the width of roundings may be the reason.
/// @param events      of the regularised system
/// @param trajectory  its rows, the selections among the outputs
void restate(const Regularisation& regularisation, result::Events& events, result::Trajectory& trajectory,
             result::Status& status);

}  // namespace saltus::smoothed
