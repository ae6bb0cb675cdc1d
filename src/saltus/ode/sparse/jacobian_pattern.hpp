// Which entries of a Jacobian can be other than 0, and columns that one difference serves together.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

namespace saltus::ode {

/// Holds entries of an n x n matrix column by column, rows ascending; the diagonal is always among them.
struct JacobianPattern {
  std::vector<std::size_t> start;  ///< n + 1
  std::vector<std::size_t> row;

  [[nodiscard]] std::size_t columns() const { return start.size() - 1; }
};

/// Makes a pattern from pairs (row, column), in any order and as often as one likes.
[[nodiscard]] JacobianPattern pattern_of(std::size_t n, std::vector<std::pair<std::size_t, std::size_t>> entries);

/// Returns groups of columns without a common row, each column in one of them: first fit in the order of the columns.
/// Cost: the squares of the entries of rows, summed.
[[nodiscard]] std::vector<std::vector<std::size_t>> column_groups(const JacobianPattern& pattern);

}  // namespace saltus::ode
