// What `saltus check` says of [optimize].
#pragma once

#include <optional>
#include <string>

#include "saltus/base/error.hpp"
#include "saltus/frontend/model_input.hpp"
#include "saltus/pipeline/optimal_control/describe_ocp.hpp"

namespace saltus::frontend {

/// Counts sizes per interval and of the problem, and warnings, those of the statement first; nothing for a model
/// without [optimize]. Fails for bad input as saltus optimize does.
[[nodiscard]] Expected<std::optional<pipeline::OcpOverview>> optimize_overview(const ModelInput& input);

/// Writes the same for people.
[[nodiscard]] std::string optimize_text(const pipeline::OcpOverview& overview);

}  // namespace saltus::frontend
