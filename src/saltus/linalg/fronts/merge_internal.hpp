// Blocks that are cheaper together.
#pragma once

#include <vector>

#include "saltus/linalg/fronts/block_tree_internal.hpp"

namespace saltus::linalg::fronts {

/// Returns the block of each row once blocks are merged with their parents where one front of at most 64 rows costs
/// less than two. Those that come first in the tree are tried first.
[[nodiscard]] std::vector<int> merge_blocks(const BlockTree& tree);

}  // namespace saltus::linalg::fronts
