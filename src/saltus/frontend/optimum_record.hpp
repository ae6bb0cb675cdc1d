// What an optimisation leaves to its caller to add to the result.
#pragma once

#include <optional>
#include <string>

#include "saltus/frontend/model_input.hpp"
#include "saltus/result/result.hpp"

namespace saltus::model {
struct Ocp;
}

namespace saltus::frontend {

/// Adds what the numerical method does not know: complete_record, and the problem as it was written.
/// @return a note as of complete_record
[[nodiscard]] std::optional<std::string> complete_optimum(const ModelInput& input, result::Result& result);

/// Adds the surfaces of the model with the parameters that were found.
void add_surfaces(const model::Ocp& ocp, result::Result& result);

}  // namespace saltus::frontend
