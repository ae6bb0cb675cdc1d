// The order in which the unknowns of sparse systems with one pattern are eliminated, and the entries that arise.
#pragma once

#include <cstddef>
#include <vector>

#include "saltus/ode/sparse/jacobian_pattern.hpp"

namespace saltus::ode {

/// Holds rows of something, each a part of one list.
struct RowLists {
  std::vector<std::size_t> start;  ///< rows + 1
  std::vector<std::size_t> column;
};

/// Eliminates along the diagonal in an order with few new entries: that of the minimum degree in the pattern with its
/// transpose. Row i is the unknown order[i].
struct Elimination {
  std::vector<std::size_t> order;
  RowLists entries;               ///< of the matrix, columns in the new order
  std::vector<std::size_t> slot;  ///< of each of them: its place in the pattern
  RowLists lower, upper;          ///< of the factors, without the diagonal, ascending
};

/// Cost: that of the order, and the entries of the factors.
[[nodiscard]] Elimination elimination_of(const JacobianPattern& pattern);

}  // namespace saltus::ode
