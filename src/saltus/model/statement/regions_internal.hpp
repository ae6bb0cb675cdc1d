// Modes by `indicator`: the weights of their regions, and the right-hand sides these add up to.
#pragma once

#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "saltus/model/recognition/reduction_internal.hpp"
#include "saltus/model/statement/statement_internal.hpp"

namespace saltus::model {

/// Returns the indicators of all modes that have one, with their places.
[[nodiscard]] std::vector<std::pair<SXElem, SourceLocation>> indicators(const Statement& statement);

/// Returns what all modes by `indicator` add to right-hand sides, each before it is weighted.
[[nodiscard]] std::vector<ModeRate> region_rates(const Statement& statement);

/// Returns for each state: whether a mode by `indicator` moves it.
[[nodiscard]] std::vector<bool> moved_by_regions(const Statement& statement);

/// Adds to a system its groups by `indicator` (see ModeGroup): a switching function and a selection per region behind
/// all others, and the weighted right-hand sides.
/// @param sliding  alpha nodes in which right-hand sides are interpolated
[[nodiscard]] std::optional<Error> add_regions(SxGraph& graph, const Statement& statement, const std::set<int>& sliding,
                                               System& system);

}  // namespace saltus::model
