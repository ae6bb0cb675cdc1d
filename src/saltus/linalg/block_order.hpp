// Orders of elimination for BlockLdl: where nobody knows one, and inside of large blocks.
#pragma once

#include <span>
#include <vector>

#include "saltus/linalg/matrix.hpp"

namespace saltus::linalg {

/// Returns the block of each row of a symmetric matrix, given by the places of one triangle, in an order of few new
/// entries: that of least degree (AMD) of the graph in which each equation is one node with a variable that it has.
/// Such a node has a pivot of two rows although the equation has no diagonal entry. Blocks are merged where one front
/// of at most 64 rows costs less than two.
/// @param equations  the last rows of the matrix
/// Cost: a multiple of that of AMD, beside the search for variables of the equations: at most entries * equations.
[[nodiscard]] std::vector<int> blocks_by_minimum_degree(Index size, Index equations, std::span<const int> rows,
                                                        std::span<const int> columns);

/// Returns smaller blocks, in an order of few new entries inside of each given one: that of least degree of the same
/// graph, behind all blocks before it. Merged as above.
/// @param block  of each row, as BlockLdl::analyse has it
/// Cost: for blocks of m rows, each beside d others, m^2 + m d (m + d) / 64 each, beside three analyses.
[[nodiscard]] std::vector<int> divide_blocks(Index equations, std::span<const int> rows, std::span<const int> columns,
                                             std::span<const int> block);

}  // namespace saltus::linalg
