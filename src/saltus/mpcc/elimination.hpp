// In which order the variables of a problem, and the rows with them, are eliminated from systems of linear equations.
#pragma once

#include <vector>

#include "saltus/mpcc/chain.hpp"
#include "saltus/mpcc/problem.hpp"

namespace saltus::mpcc {

/// Returns the block of each variable of a chain: elements from the last to the first, each interval's shared variables
/// with its first element, then the start, then the border. -1 for variables that the chain does not name.
[[nodiscard]] std::vector<int> elimination_blocks(const Chain& chain, int variables);

/// Returns the block of each row: the first of those of its variables; that of the last of all where it has none.
/// @param rows  how many of the pattern are asked for
[[nodiscard]] std::vector<int> blocks_of_rows(const std::vector<int>& of_variables, const Pattern& jacobian, int rows);

/// Gives each variable without a block (-1) the last of the blocks of the rows that have it: it is eliminated where
/// they are. One without rows goes to the last block.
void place_with_rows(std::vector<int>& of_variables, const Pattern& jacobian, int rows);

}  // namespace saltus::mpcc
