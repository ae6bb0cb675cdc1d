// Which right-hand sides a switching function switches.
#pragma once

#include <vector>

#include "saltus/model/system.hpp"

namespace saltus::model {

/// Returns for every switching function the states whose right-hand side has its selection, ascending; by the form of
/// the expressions, without evaluating them.
[[nodiscard]] std::vector<std::vector<int>> switched_rates(const System& system);

}  // namespace saltus::model
