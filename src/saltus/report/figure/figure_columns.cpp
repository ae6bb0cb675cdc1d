#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "saltus/base/contains.hpp"
#include "saltus/base/function_ref.hpp"
#include "saltus/report/axis_title.hpp"
#include "saltus/report/figure/figure_columns_internal.hpp"
#include "saltus/report/text_columns_internal.hpp"

namespace saltus::report {
namespace {

/// Appends rows [begin, end): all if they are few, else the first, extreme and last ones.
void append_extremes(const std::vector<double>& y, std::size_t begin, std::size_t end, std::vector<std::size_t>& rows) {
  if (end - begin <= 4) {
    for (std::size_t row = begin; row < end; ++row) rows.push_back(row);
    return;
  }
  std::size_t least = begin, greatest = begin;
  for (std::size_t k = begin; k < end; ++k) {
    if (y[k] < y[least] || std::isnan(y[least])) least = k;
    if (y[k] > y[greatest] || std::isnan(y[greatest])) greatest = k;
  }
  std::size_t chosen[] = {begin, least, greatest, end - 1};
  std::sort(std::begin(chosen), std::end(chosen));
  for (const std::size_t row : chosen) {
    if (rows.empty() || rows.back() != row) rows.push_back(row);
  }
}

/// Rows to draw: all if they are further apart than a pixel, else the extremes of each pixel, on either side of a gap.
/// Where there are several gaps in a pixel nobody sees them.
/// @param is_gap  whether the curve does not go on from a row to the next
std::vector<std::size_t> rows_of_pixels(const std::vector<double>& t, const std::vector<double>& y, double pixel,
                                        FunctionRef<bool(std::size_t)> is_gap) {
  std::vector<std::size_t> rows, ends;
  for (std::size_t i = 0; i < t.size();) {
    ends.clear();
    std::size_t k = i;
    for (; k < t.size() && (k == i || t[k] < t[i] + pixel); ++k) {
      if (k > i && is_gap(k - 1)) ends.push_back(k);
    }
    if (ends.size() > 2) ends.clear();
    ends.push_back(k);
    for (const std::size_t end : ends) append_extremes(y, std::exchange(i, end), end, rows);
  }
  return rows;
}

}  // namespace

std::vector<FigureColumn> figure_columns(const result::Result& result) {
  std::vector<FigureColumn> columns;
  const auto& trajectory = result.trajectory;
  const auto add = [&](const std::vector<std::string>& names, const auto& rows, ColumnSort sort) {
    for (std::size_t i = 0; i < names.size(); ++i) {
      const bool is_alpha = sort == ColumnSort::alpha, is_theta = sort == ColumnSort::theta;
      FigureColumn column{is_alpha   ? fmt::format("alpha({})", names[i])
                          : is_theta ? fmt::format("theta({})", names[i])
                                     : names[i],
                          sort,
                          i,
                          {}};
      if (!is_alpha && !is_theta) column.caption = result::caption_of(result.model.captions, names[i]);
      for (std::size_t row = 0; row < trajectory.t.size(); ++row) {
        const bool there = row < rows.size() && i < rows[row].size();
        column.values.push_back(there ? rows[row][i] : std::numeric_limits<double>::quiet_NaN());
      }
      columns.push_back(std::move(column));
    }
  };
  add(result.states, trajectory.x, ColumnSort::state);
  add(result.outputs, trajectory.outputs, ColumnSort::output);
  add(result.controls, trajectory.u, ColumnSort::control);
  add(result.switching_functions, trajectory.alpha, ColumnSort::alpha);
  add(result::region_labels(result.region_groups), trajectory.theta, ColumnSort::theta);
  columns.push_back({"t", ColumnSort::time, 0, trajectory.t});
  return columns;
}

std::string title_of(const FigureColumn& column) { return axis_title(column.name, column.caption.unit); }

Range time_range(const result::Result& result) {
  const auto& t = result.trajectory.t;
  if (t.empty()) return {0.0, 1.0};
  return t.front() < t.back() ? Range{t.front(), t.back()} : Range{t.front() - 0.5, t.front() + 0.5};
}

Range time_range(const result::Result& result, const FigureOverlays& overlays) {
  Range hull = time_range(result);
  for (const auto& overlay : overlays) {
    const Range own = time_range(overlay.result);
    hull = {std::min(hull.from, own.from), std::max(hull.to, own.to)};
  }
  return hull;
}

const FigureColumn* FigureOverlay::like(const FigureColumn& column) const {
  const auto found = std::find_if(columns.begin(), columns.end(), [&](const FigureColumn& one) {
    return one.name == column.name && one.sort == column.sort;
  });
  return found == columns.end() ? nullptr : &*found;
}

std::string heading_of(const result::Result& result) {
  return result.model.name.empty() ? "simulation" : result.model.name;
}

std::string title_line(const result::Result& result, const std::string& rest) {
  constexpr std::size_t letters = 115, fewest = 20;
  return shortened(shortened(heading_of(result), std::max(fewest, letters - std::min(letters, width(rest)))) + rest,
                   letters);
}

Range range_of(const std::vector<double>& values) {
  Range range{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    range.from = std::min(range.from, value);
    range.to = std::max(range.to, value);
  }
  return range.from <= range.to ? range : Range{0.0, 0.0};
}

Range roomy(Range range) {
  const double width = range.to - range.from;
  const double room = width > 0.0 ? 0.06 * width : std::max(0.1 * std::abs(range.from), 1e-3);
  return {range.from - room, range.to + room};
}

bool moves(const std::vector<double>& values) {
  const Range range = range_of(values);
  return range.to - range.from > 1e-12 * std::max(std::abs(range.from), std::abs(range.to));
}

bool is_discrete(const std::vector<double>& t, const std::vector<double>& values) {
  for (std::size_t i = 1; i < t.size(); ++i) {
    if (values[i] != values[i - 1] && t[i] != t[i - 1]) return false;
  }
  return moves(values);
}

bool slides(const result::Trajectory& trajectory, std::size_t row) {
  const auto& modes = trajectory.mode;
  if (row < modes.size() && contains(modes[row], 0)) return true;
  const auto& regions = trajectory.regions;
  return row < regions.size() &&
         std::any_of(regions[row].begin(), regions[row].end(), [](const auto& active) { return active.size() > 1; });
}

std::vector<Chattering> chattering_pixels(const std::vector<double>& t, const std::vector<double>& y, double pixel,
                                          double least_jump) {
  struct Place {
    double t, area;  ///< the integral up to there
  };
  std::vector<Chattering> pixels;
  double area = 0.0;
  std::optional<Place> rise;  // the last jump upwards
  for (std::size_t i = 0; i < t.size();) {
    Chattering part{i, i, t[i], t[i], y[i], y[i], 0.0};
    const Place start{t[i], area};
    auto first = rise && t[i] - rise->t < 2.0 * pixel ? rise : std::nullopt;
    int jumps = 0;
    std::size_t k = i;
    for (; k < t.size() && (k == i || t[k] < t[i] + pixel); ++k) {
      part.low = std::fmin(part.low, y[k]);
      part.high = std::fmax(part.high, y[k]);
      if (k > i && t[k] == t[k - 1] && std::abs(y[k] - y[k - 1]) > least_jump) {
        ++jumps;
        if (y[k] > y[k - 1]) rise = Place{t[k], area};
        if (y[k] > y[k - 1] && !first) first = rise;
      }
      const double piece = k + 1 < t.size() ? 0.5 * (y[k] + y[k + 1]) * (t[k + 1] - t[k]) : 0.0;
      if (std::isfinite(piece)) area += piece;
    }
    part.end = k;
    part.to = t[std::min(k, t.size() - 1)];
    const Place stop{part.to, area};
    const bool whole = first && rise->t > first->t;
    const auto [a, b] = whole ? std::pair(*first, *rise) : std::pair(start, stop);
    part.mean = (b.area - a.area) / (b.t - a.t);
    if (jumps > 1 && part.to > part.from && std::isfinite(part.mean)) pixels.push_back(part);
    i = k;
  }
  return pixels;
}

void draw_pieces(Svg& svg, const CurvePieces& pieces, const Pen& pen, std::string_view jump_color, double wide) {
  for (const auto& piece : pieces.lines) {
    const Pen own = piece.sliding && wide > 0.0 ? Pen{paper::sliding, wide} : pen;
    if (piece.points.size() == 1) svg.disc(piece.points.front(), own.width / 2, own.color, "none");
    svg.path(piece.points, own);
  }
  for (const auto& jump : pieces.jumps) svg.path(jump, {jump_color, 1.0, "2 3"});
}

CurvePieces curve_pieces(const result::Trajectory& trajectory, const std::vector<double>& x,
                         const std::vector<double>& y, const Plot& plot, double pixel, bool steps,
                         const std::vector<Chattering>& left_out) {
  CurvePieces pieces;
  const auto& t = trajectory.t;
  // A hundredth of a pixel; below it are the roundings of states that were put onto a surface.
  const double least_x = 1e-5 * (plot.x.to - plot.x.from), least_y = 1e-5 * (plot.y.to - plot.y.from);
  const auto is_there = [&](std::size_t row) { return std::isfinite(x[row]) && std::isfinite(y[row]); };
  const auto jumps = [&](std::size_t from, std::size_t to) {
    return t[from] == t[to] && (std::abs(x[from] - x[to]) > least_x || std::abs(y[from] - y[to]) > least_y);
  };
  const auto is_gap = [&](std::size_t row) { return jumps(row, row + 1) || is_there(row) != is_there(row + 1); };
  std::size_t previous = 0;
  bool open = false;
  auto gap = left_out.begin();
  for (const std::size_t row : rows_of_pixels(t, y, pixel, is_gap)) {
    while (gap != left_out.end() && gap->end <= row) ++gap;
    const bool is_left_out = gap != left_out.end() && gap->begin < row;
    if (is_left_out || !is_there(row)) {
      open = false;
      continue;
    }
    const Point here = plot.place(x[row], y[row]);
    const bool together = open && t[previous] == t[row];
    if (open && jumps(previous, row) && !steps) {
      pieces.jumps.push_back({plot.place(x[previous], y[previous]), here});
      open = false;
    }
    const bool sliding = slides(trajectory, open ? previous : row);
    if (!open) {
      pieces.lines.push_back({{here}, {t[row]}, sliding});
    } else {
      if (!together && pieces.lines.back().sliding != sliding)
        pieces.lines.push_back({{pieces.lines.back().points.back()}, {t[previous]}, sliding});
      pieces.lines.back().points.push_back(here);
      pieces.lines.back().t.push_back(t[row]);
    }
    open = true;
    previous = row;
  }
  return pieces;
}

}  // namespace saltus::report
