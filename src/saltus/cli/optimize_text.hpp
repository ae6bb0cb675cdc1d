// What `saltus check` prints of [optimize].
#pragma once

#include <string>

#include "saltus/base/error.hpp"
#include "saltus/cli/model_input.hpp"

namespace saltus::cli {

/// Sizes per interval and of the problem, and warnings; empty for a model without [optimize]. Fails for bad input as
/// saltus optimize does.
[[nodiscard]] Expected<std::string> optimize_text(const ModelInput& input);

}  // namespace saltus::cli
