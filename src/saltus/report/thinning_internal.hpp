// Fewer rows of a long trajectory, chosen so that a drawing does not change.
#pragma once

#include <cstddef>
#include <vector>

#include "saltus/result/result.hpp"

namespace saltus::report {

/// Rows that a drawing of the trajectory needs.
///
/// Always kept: the first and the last row, every row that shares its time with a neighbour (both sides of an event),
/// both rows around a change of mode. The others are cut into runs of equal length, of each run those rows stay that
/// hold the least, the greatest or the first non-finite value of a column.
///
/// @param limit  number of rows to aim at, > 0; only the rows that are always kept may exceed it.
/// @return       ascending row numbers; all of them if there are no more than `limit`. Cost: O(rows * columns).
[[nodiscard]] std::vector<std::size_t> rows_to_draw(const result::Trajectory& trajectory, std::size_t limit);

/// Number of columns with real values: states, controls, alpha, outputs (of the first row).
[[nodiscard]] std::size_t number_of_columns(const result::Trajectory& trajectory);

}  // namespace saltus::report
