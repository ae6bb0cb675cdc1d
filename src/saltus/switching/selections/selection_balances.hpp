// Which conditions share selections.
#pragma once

#include <cstddef>
#include <vector>

#include "saltus/linalg/matrix.hpp"

namespace saltus::switching {

/// Holds conditions a + B lambda = 0 that share selections, directly or by others: what determines selections.
struct Balance {
  std::vector<std::size_t> functions;  ///< rows of B
  std::vector<std::size_t> rows;       ///< columns of B: the selections that are in it
};

struct Balances {
  std::vector<Balance> all;
  std::vector<std::size_t> unused;  ///< columns that are in none
};

/// Finds the balances of conditions with these effects of selections.
/// @param effects  B, r x q
/// @param terms    sizes of what each entry is the sum of (gradient times jump): what is below 1e-9 of these is 0
/// @return         by their first function; no function and no selection is in two of them
[[nodiscard]] Balances balances_of(const linalg::Matrix& effects, const linalg::Matrix& terms);

}  // namespace saltus::switching
