// Impacts of an optimum that lie where control intervals end.
#pragma once

#include <vector>

#include "saltus/result/result.hpp"

namespace saltus::result {

/// Returns the times of impacts at inner nodes of the grid. One that moves into the next interval is on another branch,
/// which no certificate looks at; moves of the solver do if it has room there.
[[nodiscard]] std::vector<double> impacts_at_nodes(const Result& result);

}  // namespace saltus::result
