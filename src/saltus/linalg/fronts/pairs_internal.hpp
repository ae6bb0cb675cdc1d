// Equations and variables that are eliminated together.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "saltus/base/at.hpp"

namespace saltus::linalg::fronts {

/// Compressed lists of neighbours.
struct Graph {
  std::vector<int> start, neighbour;

  Graph(int size, std::vector<std::pair<int, int>> edges);
  [[nodiscard]] std::span<const int> of(int node) const {
    return std::span(neighbour).subspan(at(start[at(node)]), at(start[at(node) + 1] - start[at(node)]));
  }
};

/// Returns the node of each row: as many equations as can be are one with a variable that they have. Such a node has a
/// pivot of two rows although the equation has no diagonal entry.
/// @param equations  the last rows
/// Cost: at most entries * equations.
[[nodiscard]] std::vector<int> pair_equations(int size, int equations, std::span<const int> rows,
                                              std::span<const int> columns);

}  // namespace saltus::linalg::fronts
