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

/// Holds which rows stay where none are wanted at events.
struct WantedRows {
  std::vector<double> times;  ///< ascending; empty: all times of rows stay
  bool last = true;           ///< the last row, too, if it is at none of them

  [[nodiscard]] bool has(double t) const;
};

/// Returns those of a grid.
/// @param times  of its rows (row_times)
[[nodiscard]] WantedRows wanted_rows(const OutputGrid& grid, std::vector<double> times);

/// Leaves one row at each time, that after an event; of those that are not at a wanted time at most the last one, which
/// stays where it would be the only one.
void leave_out_event_rows(const WantedRows& wanted, result::Trajectory& rows);

}  // namespace saltus::pipeline
