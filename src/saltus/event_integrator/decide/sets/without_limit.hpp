// Right-hand sides that have no limit at a point, whatever the selections: 0/0 of controllers of homogeneity degree 0.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "saltus/event_integrator/decide/transition.hpp"

namespace saltus::event_integrator {

/// Returns what to say where f has no limit at (t, x): there no selection says what follows. There f differs as much at
/// a thousandth of a distance as at the distance itself, between points with the same listed selections. `distance` is
/// what counts as near, such as atol. Returns nullopt in these cases:
/// - f has limits: |x|^c has them, and differs less by a factor 1000^c, c down to 1/10;
/// - f jumps by itself (cells, regions by indicator);
/// - there are more than 100 states.
/// Cost: 8 n evaluations of f.
[[nodiscard]] std::optional<std::string> without_limit(const SwitchingContext& switching_context, double t,
                                                       const std::vector<double>& x, const std::vector<double>& alpha,
                                                       double distance);

}  // namespace saltus::event_integrator
