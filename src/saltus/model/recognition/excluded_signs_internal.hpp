// Signs that switching functions cannot have together: x > 2 with x < 1, n > 2 with n < 2.
#pragma once

#include <vector>

#include "saltus/model/recognition/recognition_internal.hpp"

namespace saltus::model {

/// Holds two literals (functions by their numbers) that do not have these values at once.
struct ExcludedSigns {
  int a = 0;
  bool a_holds = false;
  int b = 0;
  bool b_holds = false;
};

/// Returns what parallel thresholds exclude, and discrete functions that are the same but for their value at 0. Of
/// parallel ones only neighbours are paired, in the order of their thresholds: the rest follows, and n of them make n -
/// 1 pairs. Cost: quadratic in the number of literals, 64 comparisons a pair.
[[nodiscard]] std::vector<ExcludedSigns> excluded_signs(const Tape& tape, const std::vector<MetFunction>& functions,
                                                        const std::vector<int>& literals);

}  // namespace saltus::model
