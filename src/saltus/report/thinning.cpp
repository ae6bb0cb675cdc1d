#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "saltus/report/thinning_internal.hpp"

namespace saltus::report {
namespace {

template <class Visit>
void for_each_table(const result::Trajectory& trajectory, Visit visit) {
  visit(trajectory.x), visit(trajectory.u), visit(trajectory.alpha), visit(trajectory.outputs);
  visit(trajectory.theta);
}

bool is_pair(const result::Trajectory& trajectory, std::size_t i) {
  const bool mode_changes = i < trajectory.mode.size() && trajectory.mode[i - 1] != trajectory.mode[i];
  const bool regions_change = i < trajectory.regions.size() && trajectory.regions[i - 1] != trajectory.regions[i];
  return trajectory.t[i - 1] == trajectory.t[i] || mode_changes || regions_change;
}

void keep_pairs(const result::Trajectory& trajectory, std::size_t limit, std::vector<char>& keep) {
  keep.front() = keep.back() = 1;
  std::size_t pairs = 0;
  for (std::size_t i = 1; i < trajectory.t.size(); ++i) pairs += is_pair(trajectory, i) ? 1U : 0U;
  const std::size_t most = std::max<std::size_t>(1, limit / 4);
  const std::size_t stride = (pairs + most - 1) / most;
  std::size_t count = 0;
  for (std::size_t i = 1; i < trajectory.t.size(); ++i) {
    if (is_pair(trajectory, i) && count++ % stride == 0) keep[i - 1] = keep[i] = 1;
  }
}

struct Run {
  std::size_t begin, end;
};

/// Marks the extremes of one column within a run, and where it first has no finite value.
template <class Rows>
void keep_extremes(const Rows& rows, std::size_t column, Run run, std::vector<char>& keep) {
  std::size_t least = run.end, greatest = run.end, missing = run.end;
  for (std::size_t i = run.begin; i < run.end; ++i) {
    const double value = rows[i][column];
    if (!std::isfinite(value)) {
      if (missing == run.end) missing = i;
    } else {
      if (least == run.end || value < rows[least][column]) least = i;
      if (greatest == run.end || value > rows[greatest][column]) greatest = i;
    }
  }
  for (const std::size_t i : {least, greatest, missing}) {
    if (i < run.end) keep[i] = 1;
  }
}

}  // namespace

std::vector<std::size_t> straight_places(const std::vector<double>& t, const std::vector<double>& values,
                                         double tolerance) {
  std::vector<std::size_t> places;
  const std::size_t size = values.size();
  if (size == 0) return places;
  constexpr double infinity = std::numeric_limits<double>::infinity();
  places.push_back(0);
  double lowest = -infinity, highest = infinity;  // slopes of lines from the last place that pass all values since
  const auto begin_at = [&](std::size_t i) {
    if (places.back() != i) places.push_back(i);
    lowest = -infinity, highest = infinity;
  };
  for (std::size_t i = 1; i < size; ++i) {
    const bool there = std::isfinite(values[i]), before = std::isfinite(values[i - 1]);
    const bool jumps = t[i] == t[i - 1] && values[i] != values[i - 1];
    if (!there && !before) continue;
    if (there != before || jumps) {
      begin_at(i - 1);
      begin_at(i);
      continue;
    }
    const std::size_t from = places.back();
    if (t[i] == t[from]) continue;
    const double dt = t[i] - t[from], slope = (values[i] - values[from]) / dt;
    if (slope < lowest || slope > highest) {
      begin_at(i - 1);
      if (t[i] == t[i - 1]) continue;
    }
    const double reach = t[i] - t[places.back()], rise = values[i] - values[places.back()];
    lowest = std::max(lowest, (rise - tolerance) / reach);
    highest = std::min(highest, (rise + tolerance) / reach);
  }
  begin_at(size - 1);
  return places;
}

std::size_t number_of_columns(const result::Trajectory& trajectory, std::size_t most_columns) {
  std::size_t count = 0;
  for_each_table(trajectory, [&](const auto& rows) { count += std::min(most_columns, rows.width()); });
  return count;
}

std::vector<std::size_t> rows_to_draw(const result::Trajectory& trajectory, std::size_t limit,
                                      std::size_t most_columns) {
  const std::size_t size = trajectory.t.size();
  std::vector<std::size_t> chosen(size);
  std::iota(chosen.begin(), chosen.end(), std::size_t{0});
  if (size <= limit) return chosen;

  std::vector<char> keep(size, 0);
  keep_pairs(trajectory, limit, keep);
  // Least and greatest of every column: two rows per column and run.
  const std::size_t runs = std::max<std::size_t>(1, limit / (2 * number_of_columns(trajectory, most_columns) + 1));
  const std::size_t length = (size + runs - 1) / runs;
  for_each_table(trajectory, [&](const auto& rows) {
    if (rows.size() != size) return;
    for (std::size_t column = 0; column < std::min(most_columns, rows.width()); ++column) {
      for (std::size_t begin = 0; begin < size; begin += length) {
        keep_extremes(rows, column, {begin, std::min(size, begin + length)}, keep);
      }
    }
  });
  std::erase_if(chosen, [&](std::size_t i) { return keep[i] == 0; });
  return chosen;
}

}  // namespace saltus::report
