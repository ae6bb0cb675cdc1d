// Which rows a trajectory has.
#pragma once

#include <variant>
#include <vector>

#include "saltus/pipeline/options/simulate_options.hpp"
#include "saltus/result/result.hpp"

namespace saltus::pipeline {

/// With Automatic: lines between rows are so close to every column, in parts of its range.
inline constexpr double straight_share = 1e-3;

/// Returns whether rows are asked for at given times.
[[nodiscard]] inline bool is_at_times(const OutputGrid& grid) {
  return !std::holds_alternative<Automatic>(grid) && !std::holds_alternative<EveryStep>(grid);
}

/// Returns the times of the rows that are asked for, beside those at events and the last one; none for rows at steps.
[[nodiscard]] std::vector<double> row_times(const OutputGrid& grid, double from, double until);

/// Leaves one row at each time, that behind an event; of those that are not at one of `times` the last one only.
/// @param times  ascending; empty: all times of rows stay
void leave_out_event_rows(const std::vector<double>& times, result::Trajectory& rows);

}  // namespace saltus::pipeline
