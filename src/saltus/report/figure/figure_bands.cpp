#include <algorithm>
#include <array>
#include <iterator>
#include <numeric>

#include "saltus/report/figure/figure_columns_internal.hpp"
#include "saltus/report/text_columns_internal.hpp"

namespace saltus::report {
namespace {

/// One stretch of a band: how much of its time the mode is -1, 0 and 1.
struct BandCell {
  double from = 0.0, to = 0.0;  ///< pixels
  std::array<double, 3> share{};
  std::size_t mode = 0;  ///< the last one, by its place in `share`
  int count = 1;         ///< intervals in it
};

/// Intervals of a mode as they are, those that share a pixel together.
std::vector<BandCell> band_cells(const result::Trajectory& trajectory, std::size_t j, const Plot& time) {
  std::vector<BandCell> cells;
  for (std::size_t i = 0; i + 1 < trajectory.t.size(); ++i) {
    if (i >= trajectory.mode.size() || j >= trajectory.mode[i].size() || trajectory.t[i] == trajectory.t[i + 1])
      continue;
    const double from = time.place(trajectory.t[i], 0.0).x, to = time.place(trajectory.t[i + 1], 0.0).x;
    const auto mode = static_cast<std::size_t>(trajectory.mode[i][j] + 1);
    const bool same = !cells.empty() && cells.back().count == 1 && cells.back().mode == mode;
    const bool near = !cells.empty() && to - cells.back().from < 1.0;
    if (!same && !near) cells.push_back({from, from, {}, mode, 1});
    auto& cell = cells.back();
    if (cell.mode != mode) ++cell.count;
    cell.mode = mode;
    cell.share[mode] += to - cell.to;
    cell.to = to;
  }
  return cells;
}

}  // namespace

std::vector<std::size_t> banded(const result::Result& result) {
  std::vector<std::size_t> all(result.switching_functions.size()), changing;
  std::iota(all.begin(), all.end(), std::size_t{0});
  const auto& modes = result.trajectory.mode;
  std::copy_if(all.begin(), all.end(), std::back_inserter(changing), [&](std::size_t j) {
    for (std::size_t i = 1; i < modes.size(); ++i) {
      if (j < modes[i].size() && j < modes[i - 1].size() && modes[i][j] != modes[i - 1][j]) return true;
    }
    return false;
  });
  if (all.size() > most_panels && !changing.empty()) all = std::move(changing);
  return {all.begin(), all.begin() + static_cast<std::ptrdiff_t>(std::min(all.size(), most_panels))};
}

double draw_bands(Svg& svg, const result::Result& result, const std::vector<std::size_t>& bands, const Plot& time,
                  double top, DrawnModes& drawn) {
  constexpr double height = 16.0, gap = 2.0, lane = height / 2 - gap;
  for (const std::size_t j : bands) {
    const double middle = top + height / 2;
    for (const auto& cell : band_cells(result.trajectory, j, time)) {
      const double wide = cell.to - cell.from;
      if (!(wide > 0.0)) continue;
      const double minus = lane * cell.share[0] / wide, plus = lane * cell.share[2] / wide;
      drawn.minus |= minus > 0.0, drawn.sliding |= cell.share[1] > 0.0, drawn.plus |= plus > 0.0;
      drawn.chattering |= cell.count > 1;
      if (cell.count > 1) svg.rectangle({cell.from, middle - gap}, wide, 2.0 * gap, hatched);
      if (minus > 0.0) svg.rectangle({cell.from, middle + gap}, wide, minus, paper::minus);
      if (plus > 0.0) svg.rectangle({cell.from, middle - gap - plus}, wide, plus, paper::plus);
      const bool whole = cell.count == 1;
      if (cell.share[1] > 0.0)
        svg.rectangle({cell.from, whole ? top : middle - gap}, wide, whole ? height : 2.0 * gap, paper::sliding);
    }
    svg.text({time.corner.x + time.width + 8.0, top + 12.0}, shortened(result.switching_functions[j], letters_beside),
             "start", paper::text);
    top += height + 4.0;
  }
  return top + 8.0;
}

}  // namespace saltus::report
