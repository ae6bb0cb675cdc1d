// Where terminal constraints want single states to end.
#pragma once

#include <optional>
#include <vector>

#include "saltus/base/error.hpp"
#include "saltus/model/ocp.hpp"
#include "saltus/pipeline/optimal_control/point_values_internal.hpp"

namespace saltus::pipeline {

/// Returns for every state b' with x_i(T) = b' if a hard terminal constraint says so: c x_i + d == b with c, d of
/// parameters. Fails (invalid_model) if the symbolic layer refuses an expression.
[[nodiscard]] Expected<std::vector<std::optional<double>>> linear_targets(const model::Ocp& ocp,
                                                                          const std::vector<double>& parameters,
                                                                          PointValues& values);

}  // namespace saltus::pipeline
