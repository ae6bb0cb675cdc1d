#include <algorithm>
#include <cstddef>
#include <utility>
#include <variant>

#include "saltus/pipeline/options/option_fields.hpp"
#include "saltus/pipeline/simulate/output_rows_internal.hpp"

namespace saltus::pipeline {
std::vector<double> row_times(const OutputGrid& grid, double from, double until) {
  if (!is_at_times(grid)) return {};
  if (const auto* at = std::get_if<AtTimes>(&grid)) return at->times;
  std::vector<double> times;
  const auto* points = std::get_if<NumberOfPoints>(&grid);
  const auto* every = std::get_if<EveryInterval>(&grid);
  const double count = number_of_rows(grid, from, until) - 1.0;
  for (double i = 0.0; i <= count; i += 1.0) {
    const double t = points ? from + (until - from) * (i / count) : from + i * every->interval;
    // The last multiple may miss `until` by its rounding: one row, not two.
    times.push_back(until - t <= 1e-12 * (until - from) ? until : t);
  }
  return times;
}

WantedRows wanted_rows(const OutputGrid& grid, std::vector<double> times) {
  return {std::move(times), !std::holds_alternative<AtTimes>(grid)};
}

bool WantedRows::has(double t) const { return times.empty() || std::binary_search(times.begin(), times.end(), t); }

void leave_out_event_rows(const WantedRows& wanted, result::Trajectory& rows) {
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < rows.t.size(); ++i) {
    const bool last = i + 1 == rows.t.size();
    if (!last && rows.t[i + 1] == rows.t[i]) continue;  // values are continuous from the right
    const bool stays = last && (wanted.last || kept.empty());
    if (stays || wanted.has(rows.t[i])) kept.push_back(i);
  }
  rows.keep(kept);
}

}  // namespace saltus::pipeline
