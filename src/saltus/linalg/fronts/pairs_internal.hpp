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

/// Returns the equation that each variable is a pair with, or -1: as many equations as can be have a variable of
/// theirs. A pair has a pivot of two rows although the equation has no diagonal entry.
/// @param equations  the last rows, numbered from 0
/// @param block      of each row: pairs inside of blocks are looked for first; may be empty
/// Cost: at most entries * equations.
[[nodiscard]] std::vector<int> pair_equations(int size, int equations, std::span<const int> rows,
                                              std::span<const int> columns, std::span<const int> block = {});

/// Returns the node of each row: pairs are one.
[[nodiscard]] std::vector<int> nodes_of_pairs(const std::vector<int>& equation, int size);

}  // namespace saltus::linalg::fronts
