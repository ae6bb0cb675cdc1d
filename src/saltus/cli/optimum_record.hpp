// What an optimisation leaves to its caller to add to the result.
#pragma once

#include "saltus/cli/model_input.hpp"
#include "saltus/result/result.hpp"

namespace saltus::model {
struct Ocp;
}

namespace saltus::cli {

/// Adds what the numerical method does not know: complete_record, and the problem as it was written.
void complete_optimum(const ModelInput& input, result::Result& result);

/// Adds the surfaces of the model with the parameters that were found.
void add_surfaces(const model::Ocp& ocp, result::Result& result);

}  // namespace saltus::cli
