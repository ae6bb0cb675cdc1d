// Right-hand sides that have no limit at a point, whatever the selections: 0/0 of controllers of homogeneity degree 0.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "saltus/event_integrator/decide/transition.hpp"

namespace saltus::event_integrator {

/// What to say where f differs around (t, x) as much at a thousandth of a distance as at the distance itself, between
/// points that have the same listed selections: there no selection says what follows. `distance`: what counts as near,
/// such as atol. nullopt where f has limits (|x|^c has them, and differs less by a factor 1000^c, c down to 1/10),
/// where it jumps by itself (cells, regions by indicator), and with more than 100 states. Cost: 8 n evaluations of f.
[[nodiscard]] std::optional<std::string> without_limit(const SwitchingContext& switching_context, double t,
                                                       const std::vector<double>& x, const std::vector<double>& alpha,
                                                       double distance);

}  // namespace saltus::event_integrator
