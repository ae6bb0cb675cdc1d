// What a run shows, awaits or assigns while a surface slides.
#pragma once

#include <optional>
#include <set>

#include "saltus/model/graph/sx_graph_internal.hpp"
#include "saltus/model/system.hpp"

namespace saltus::model {

/// Replaces outputs, functions of events, guards and values of jumps by their interpolations, as right-hand sides are:
/// the mean of infinitely fast switching, not the expression at the mean of the selections. Nothing where the model has
/// the inclusion of Aizerman and Pyatnitskii. Returns an error if a term needs more than 64 corners.
/// @param sliding  nodes of the alphas that can take values between 0 and 1
[[nodiscard]] std::optional<Error> interpolate_quantities(SxGraph& graph, const std::set<int>& sliding, System& system);

}  // namespace saltus::model
