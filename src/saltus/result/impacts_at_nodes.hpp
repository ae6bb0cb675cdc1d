// Impacts of an optimum that lie where control intervals end.
#pragma once

#include <string>

#include "saltus/result/result.hpp"

namespace saltus::result {

/// Returns the times of impacts at inner nodes of the grid, with commas between; empty without any. An impact cannot
/// move from one interval into the next: that is another branch, which no certificate looks at.
[[nodiscard]] std::string impacts_at_nodes(const Result& result);

}  // namespace saltus::result
