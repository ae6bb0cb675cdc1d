// What `saltus check` prints.
#pragma once

#include <string>

#include "saltus/base/error.hpp"
#include "saltus/cli/model_input.hpp"
#include "saltus/pipeline/simulate.hpp"

namespace saltus::cli {

/// States, parameters, switching functions with their kinds, what every method makes of them, warnings. Fails where the
/// model states no system. Cost: a simulation, for the ranks along it, that `observers` see.
[[nodiscard]] Expected<std::string> check_text(const ModelInput& input, const pipeline::Observers& observers);

}  // namespace saltus::cli
