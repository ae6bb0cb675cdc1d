// Optima of several starts, each found by itself -> the one that a single process would have given.
#pragma once

#include <memory>
#include <vector>

#include "saltus/result/result.hpp"

namespace saltus::frontend {

/// Returns the best of optima that were found with `optimize.mpcc.seed`, one for each seed: the result of
/// `optimize.mpcc.starts`, with the outcomes of all in the order of their seeds. Times are those of the one that is
/// taken.
/// @param optima  at least one, each with Optimization::starts of its own seed
[[nodiscard]] result::Result best_of_starts(const std::vector<std::shared_ptr<result::Result>>& optima);

}  // namespace saltus::frontend
