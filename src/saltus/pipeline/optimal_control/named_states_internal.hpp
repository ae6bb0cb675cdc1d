// Where costs and terminal constraints want states to be.
#pragma once

#include <optional>
#include <vector>

#include "saltus/model/ocp.hpp"
#include "saltus/pipeline/optimal_control/ocp_guess.hpp"
#include "saltus/pipeline/optimal_control/point_values_internal.hpp"

namespace saltus::pipeline {

/// Returns states at these times, row by row, that need not be a motion:
///   x(t) = c(t) + (1 - s) (x(from) - c(from)) + s (e - c(until)),   s = (t - from) / (until - from),
/// c(t) where the integrand of the cost is smallest over x, e where terminal constraints or, without one, terminal
/// costs want x to end. For states that costs do not bend upwards at x(from) c is 0 and e = x(from): they are constant.
/// Costs are exact where they are quadratic.
/// Cost: some ten evaluations of the costs per interval and state.
/// @param start  horizon, parameters, controls and initial state
/// @param targets  of terminal constraints (linear_targets)
[[nodiscard]] std::vector<std::vector<double>> named_states(const model::Ocp& ocp, PointValues& values,
                                                            const OcpStart& start,
                                                            const std::vector<std::optional<double>>& targets,
                                                            const std::vector<double>& times);

}  // namespace saltus::pipeline
