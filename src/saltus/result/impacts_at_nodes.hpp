// Impacts of an optimum that lie where control intervals end.
#pragma once

#include <vector>

#include "saltus/result/result.hpp"

namespace saltus::result {

/// Returns the times of impacts at inner nodes of the grid. An impact cannot move from one interval into the next: that
/// is another branch, which no certificate looks at.
[[nodiscard]] std::vector<double> impacts_at_nodes(const Result& result);

}  // namespace saltus::result
