// Which states of a description change by jumps only.
#pragma once

#include <vector>

#include "saltus/model/description.hpp"

namespace saltus::model {

/// Returns one flag per state: its right-hand side is stated, in [dynamics] or in modes, and is 0 wherever it is, an
/// expression of numbers (also by way of definitions) that comes to 0. A parameter that happens to be 0 does not count.
[[nodiscard]] std::vector<bool> discrete_states(const Description& description);

}  // namespace saltus::model
