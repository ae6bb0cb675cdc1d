// Fewer rows of a long trajectory, chosen so that a drawing does not change.
#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "saltus/result/result.hpp"

namespace saltus::report {

/// Returns the rows that a drawing of the trajectory needs.
///
/// Kept are the first and the last row, and pairs of rows that share their time (both sides of an event) or have a
/// change of mode between them. All pairs are kept, or every k-th with the least k that leaves half of `limit` at most.
/// The other rows are cut into runs of equal length. Of each run those rows stay that hold the least, the greatest or
/// the first non-finite value of a column.
///
/// @param limit         number of rows to aim at, > 0; exceeded by at most its half and twice the number of columns.
/// @param most_columns  columns of each table that are drawn
/// @return              ascending row numbers; all of them if there are no more than `limit`. Cost: O(rows * columns).
[[nodiscard]] std::vector<std::size_t> rows_to_draw(const result::Trajectory& trajectory, std::size_t limit,
                                                    std::size_t most_columns = std::numeric_limits<std::size_t>::max());

/// Returns places of a curve between which straight lines are within `tolerance` of all of its values. Both sides of a
/// jump (two values at one time) and of missing values stay. Greedy: each line is as long as lines from its begin that
/// end on the curve can be. Cost: O(values).
[[nodiscard]] std::vector<std::size_t> straight_places(const std::vector<double>& t, const std::vector<double>& values,
                                                       double tolerance);

/// Returns the number of columns with real values: states, controls, alpha, outputs (of the first row), at most so many
/// of each.
[[nodiscard]] std::size_t number_of_columns(const result::Trajectory& trajectory,
                                            std::size_t most_columns = std::numeric_limits<std::size_t>::max());

}  // namespace saltus::report
