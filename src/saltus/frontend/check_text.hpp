// What `saltus check` prints.
#pragma once

#include <optional>
#include <string>

#include "saltus/base/error.hpp"
#include "saltus/frontend/model_input.hpp"
#include "saltus/io/check/model_overview.hpp"
#include "saltus/pipeline/optimal_control/describe_ocp.hpp"

namespace saltus::model {
struct System;
}

namespace saltus::frontend {

/// Writes quantities, equations, switching functions, what every method makes of them, sizes of [optimize], warnings.
/// Simulates nothing.
/// @param system  of the input, with its overview and the sizes of [optimize]
[[nodiscard]] std::string check_text(const ModelInput& input, const model::System& system,
                                     const io::ModelOverview& overview,
                                     const std::optional<pipeline::OcpOverview>& optimization);

/// Writes the same of a model alone. Fails where it states no system.
[[nodiscard]] Expected<std::string> check_text(const ModelInput& input);

}  // namespace saltus::frontend
