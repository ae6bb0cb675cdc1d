// One surface on which the selection enters other than affinely (Aizerman-Pyatnitskii models).
#pragma once

#include "saltus/base/function_ref.hpp"
#include "saltus/switching/table/surface_decision.hpp"

namespace saltus::switching {

/// Decides a surface with normal component g(alpha), alpha in [0, 1], by following the hidden dynamics alpha' ~
/// g(alpha). It starts from the side the solution comes from (at the start: from the side the fields point away from;
/// where the selection was lost: from `lost_at`). It goes in the direction of g to its first zero, which is the sliding
/// selection. If there is none the solution leaves on that side.
/// @param situation  g(0), g(1) with their drifts, and the arrival
/// @param lost_at    selection that ceased to exist, for Arrival::along
/// Cost: about 300 evaluations of g.
[[nodiscard]] SurfaceDecision decide_selection(const SurfaceSituation& situation, FunctionRef<double(double)> g,
                                               double lost_at);

}  // namespace saltus::switching
