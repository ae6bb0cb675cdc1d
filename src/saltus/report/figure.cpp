#include "saltus/report/figure.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "saltus/report/figure/figure_columns_internal.hpp"
#include "saltus/report/figure/figure_legend_internal.hpp"
#include "saltus/result/kept_columns.hpp"

namespace saltus::report {
namespace {

constexpr double width = 960.0, left = 70.0, right = 110.0;
constexpr std::string_view sliding_color = "#ef7d00", minus_color = "#1f4e8c", plus_color = "#9cc9ee",
                           jump_color = "#0b7285", alarm_color = "#c2185b";
constexpr std::array<std::string_view, 6> curve_colors{"#1f66b0", "#11806a", "#8a4fb0",
                                                       "#6b7400", "#5a6b7d", "#b03a5b"};
/// Panels of a figure at most: a sheet of paper is no longer.
constexpr std::size_t most_panels = 24;

Range time_range(const result::Result& result) {
  const auto& t = result.trajectory.t;
  if (t.empty()) return {0.0, 1.0};
  return t.front() < t.back() ? Range{t.front(), t.back()} : Range{t.front() - 0.5, t.front() + 0.5};
}

/// What moves, discrete states last; all if nothing moves.
std::vector<FigureColumn> columns_over_time(const result::Result& result) {
  const auto& t = result.trajectory.t;
  auto columns = figure_columns(result);
  columns.pop_back();
  auto moving = columns;
  std::erase_if(moving, [](const FigureColumn& column) { return !moves(column.values); });
  if (!moving.empty()) columns = std::move(moving);
  std::stable_partition(columns.begin(), columns.end(), [&](const FigureColumn& column) {
    return column.sort != ColumnSort::state || !is_discrete(t, column.values);
  });
  return columns;
}

std::string_view color_of(ColumnSort sort) {
  return curve_colors[std::min<std::size_t>(static_cast<std::size_t>(sort), curve_colors.size() - 1)];
}

void draw_pieces(Svg& svg, const CurvePieces& pieces, std::string_view color, double wide) {
  for (const auto& piece : pieces.lines)
    svg.path(piece.points,
             {piece.sliding && wide > 0.0 ? sliding_color : color, piece.sliding && wide > 0.0 ? wide : 1.6});
  // Of many the dots would show something that is not there.
  const bool many = pieces.jumps.size() > 200;
  for (const auto& jump : pieces.jumps) svg.path(jump, many ? Pen{color, 0.8} : Pen{jump_color, 1.0, "2 3"});
}

/// One stretch of a band: how much of its time the mode is -1, 0 and 1.
struct BandCell {
  double from = 0.0, to = 0.0;  ///< pixels
  std::array<double, 3> share{};
};

/// Intervals of a mode as they are, those shorter than a pixel together.
std::vector<BandCell> band_cells(const result::Trajectory& trajectory, std::size_t j, const Plot& time) {
  std::vector<BandCell> cells;
  for (std::size_t i = 0; i + 1 < trajectory.t.size(); ++i) {
    if (i >= trajectory.mode.size() || j >= trajectory.mode[i].size() || trajectory.t[i] == trajectory.t[i + 1])
      continue;
    const double from = time.place(trajectory.t[i], 0.0).x, to = time.place(trajectory.t[i + 1], 0.0).x;
    const auto mode = static_cast<std::size_t>(trajectory.mode[i][j] + 1);
    const bool same = !cells.empty() && cells.back().share[mode] == cells.back().to - cells.back().from;
    if (cells.empty() || (!same && cells.back().to - cells.back().from >= 1.0)) cells.push_back({from, from, {}});
    cells.back().share[mode] += to - cells.back().to;
    cells.back().to = to;
    if (same) cells.back().share[mode] = to - cells.back().from;
  }
  return cells;
}

/// Bands of the switching functions: below their middle psi < 0, above it psi > 0, all of them sliding; where they
/// chatter each half is as full as its part of the time.
double draw_bands(Svg& svg, const result::Result& result, const Plot& time, double top) {
  constexpr double height = 16.0;
  for (std::size_t j = 0; j < std::min(most_panels, result.switching_functions.size()); ++j) {
    for (const auto& [from, to, share] : band_cells(result.trajectory, j, time)) {
      const double wide = to - from, half = height / 2;
      if (!(wide > 0.0)) continue;
      const double minus = half * share[0] / wide, plus = half * share[2] / wide, middle = top + half;
      if (minus > 0.0) svg.rectangle({from, middle}, wide, minus, minus_color);
      if (plus > 0.0) svg.rectangle({from, middle - plus}, wide, plus, plus_color);
      const bool whole = share[1] == wide;
      if (share[1] > 0.0) svg.rectangle({from, whole ? top : middle - 2.0}, wide, whole ? height : 4.0, sliding_color);
    }
    svg.text({width - right + 8.0, top + 12.0}, result.switching_functions[j], "start", "#1c2430");
    top += height + 4.0;
  }
  return top + 8.0;
}

/// Events as thin lines from the top to the bottom, of many one for some pixels; those that are not unique always.
void draw_events(Svg& svg, const result::Result& result, const Plot& time, double top, double bottom) {
  const double apart = result.events.size() > 200 ? 6.0 : 1.0;
  double last = -apart;
  for (const auto& event : result.events) {
    const double x = time.place(event.t, 0.0).x;
    const bool alarming = event.unique == false;
    if (x - last < apart && !alarming) continue;
    last = x;
    const bool jump = event.kind == result::EventKind::jump;
    svg.path({{x, top}, {x, bottom}}, alarming ? Pen{alarm_color, 1.5, "5 3"}
                                      : jump   ? Pen{jump_color, 0.6, "2 2"}
                                               : Pen{"#8d97a5", 0.6});
  }
}

std::string title_of(const result::Result& result) {
  return result.model.name.empty() ? "simulation" : result.model.name;
}

/// Of the bands and the lines of events.
std::vector<LegendEntry> legend_over_time(const result::Result& result) {
  std::vector<LegendEntry> entries;
  if (!result.switching_functions.empty()) {
    entries.push_back({"psi < 0", {minus_color}, LegendEntry::Mark::box});
    entries.push_back({"sliding", {sliding_color}, LegendEntry::Mark::box});
    entries.push_back({"psi > 0", {plus_color}, LegendEntry::Mark::box});
  }
  bool jumps = false, switches = false, alarming = false;
  for (std::size_t i = 0; i < result.events.size(); ++i) {
    const bool alarm = result.events.unique(i) == false;
    const bool jump = result.events.kind(i) == result::EventKind::jump;
    alarming = alarming || alarm;
    jumps = jumps || (jump && !alarm);
    switches = switches || (!jump && !alarm);
  }
  if (switches) entries.push_back({"event", {"#8d97a5", 1.0}});
  if (jumps) entries.push_back({"jump", {jump_color, 1.0, "2 2"}});
  if (alarming) entries.push_back({"not unique", {alarm_color, 1.5, "5 3"}});
  return entries;
}

std::string over_time(const result::Result& result) {
  auto columns = columns_over_time(result);
  const std::size_t left_out = columns.size() - std::min(columns.size(), most_panels);
  columns.resize(columns.size() - left_out);
  const double panel = columns.size() > 6 ? 92.0 : 130.0, gap = 12.0;
  const double bands = 20.0 * static_cast<double>(std::min(most_panels, result.switching_functions.size()));
  const double height = 44.0 + bands + static_cast<double>(columns.size()) * (panel + gap) + 56.0;
  Svg svg(width, height);
  Plot plot{{left, 40.0}, width - left - right, panel, time_range(result), {0.0, 1.0}};
  svg.text({left, 22.0},
           fmt::format("{}: {} to t = {:.6g}{}", title_of(result), result::name(result.status.termination),
                       result.status.time_reached, left_out > 0 ? fmt::format(", {} more columns", left_out) : ""),
           "start", "#1c2430");
  double top = draw_bands(svg, result, plot, 40.0);
  draw_events(svg, result, plot, 32.0, height - 56.0);
  const double pixel = (plot.x.to - plot.x.from) / (2.0 * plot.width);
  for (std::size_t i = 0; i < columns.size(); ++i, top += panel + gap) {
    const auto& column = columns[i];
    plot.corner.y = top;
    plot.y = roomy(range_of(column.values));
    draw_axes(svg, plot, i + 1 == columns.size());
    const bool steps = column.sort == ColumnSort::state && is_discrete(result.trajectory.t, column.values);
    svg.clip(plot.corner, plot.width, plot.height);
    draw_pieces(svg, curve_pieces(result.trajectory, result.trajectory.t, column.values, plot, pixel, steps),
                color_of(column.sort), 0.0);
    svg.clip(std::nullopt);
    svg.text({width - right + 8.0, top + panel / 2}, column.name, "start", color_of(column.sort));
  }
  svg.text({left + plot.width / 2, height - 14.0}, "t", "middle", "#1c2430");
  draw_legend(svg, legend_over_time(result), left, width - 20.0, height + 2.0);
  return svg.document(title_of(result));
}

/// An affine surface as a x + b y + c over two columns, the others as they are at the end; nullopt if it is no line
/// there.
std::optional<std::array<double, 3>> line_of(const result::Result& result, const result::Surface& surface,
                                             const FigureColumn& x, const FigureColumn& y) {
  if (!surface.affine) return std::nullopt;
  std::array<double, 3> line{0.0, 0.0, surface.affine->constant};
  const bool over_time = x.sort == ColumnSort::time || y.sort == ColumnSort::time;
  if (over_time)
    line[x.sort == ColumnSort::time ? 0 : 1] = surface.affine->rate;
  else
    line[2] += surface.affine->rate * result.final.t;
  for (std::size_t i = 0; i < surface.states.size(); ++i) {
    const auto place = static_cast<std::size_t>(
        std::find(result.states.begin(), result.states.end(), surface.states[i]) - result.states.begin());
    const double slope = surface.affine->gradient[i];
    if (x.sort == ColumnSort::state && x.index == place)
      line[0] += slope;
    else if (y.sort == ColumnSort::state && y.index == place)
      line[1] += slope;
    else
      line[2] += slope * (place < result.final.x.size() ? result.final.x[place] : 0.0);
  }
  return line[0] != 0.0 || line[1] != 0.0 ? std::optional(line) : std::nullopt;
}

void draw_line(Svg& svg, const Plot& plot, const std::array<double, 3>& line, const Pen& pen) {
  const auto [a, b, c] = line;
  const double wide = plot.x.to - plot.x.from, tall = plot.y.to - plot.y.from;
  // Along the axis to which the line is nearer, seen on paper.
  if (std::abs(a * wide) > std::abs(b * tall)) {
    const auto x = [&](double y) { return -(b * y + c) / a; };
    svg.path({plot.place(x(plot.y.from), plot.y.from), plot.place(x(plot.y.to), plot.y.to)}, pen);
  } else {
    const auto y = [&](double x) { return -(a * x + c) / b; };
    svg.path({plot.place(plot.x.from, y(plot.x.from)), plot.place(plot.x.to, y(plot.x.to))}, pen);
  }
}

/// Draws the surfaces that are lines there; returns what they are called.
std::vector<LegendEntry> draw_surfaces(Svg& svg, const result::Result& result, const Plot& plot, const FigureColumn& x,
                                       const FigureColumn& y) {
  std::vector<LegendEntry> drawn;
  std::size_t n = 0;
  for (const auto& surface : result.surfaces) {
    const Pen pen{curve_colors[5 - n++ % 5], 1.2, surface.role == result::SurfaceRole::jump ? "6 2 2 2" : "7 3"};
    if (const auto line = line_of(result, surface, x, y)) {
      draw_line(svg, plot, *line, pen);
      drawn.push_back({surface.name, pen});
      continue;
    }
    if (surface.states.size() != 2 || x.sort != ColumnSort::state || y.sort != ColumnSort::state) continue;
    const auto axis = [&](const FigureColumn& column) {
      return std::find(surface.states.begin(), surface.states.end(), column.name) - surface.states.begin();
    };
    if (axis(x) > 1 || axis(y) > 1) continue;
    for (const auto& curve : surface.curves) {
      std::vector<Point> points;
      for (std::size_t k = 0; k < curve.coordinates.front().size(); ++k) {
        points.push_back(plot.place(curve.coordinates[static_cast<std::size_t>(axis(x))][k],
                                    curve.coordinates[static_cast<std::size_t>(axis(y))][k]));
      }
      svg.path(points, pen);
    }
    if (!surface.curves.empty()) drawn.push_back({surface.name, pen});
  }
  return drawn;
}

const FigureColumn* named(const std::vector<FigureColumn>& columns, const std::string& name) {
  const auto found =
      std::find_if(columns.begin(), columns.end(), [&](const auto& column) { return column.name == name; });
  return found == columns.end() ? nullptr : &*found;
}

Error unknown_column(const std::vector<FigureColumn>& columns, const std::string& name) {
  std::vector<std::string> known;
  for (const auto& column : columns) known.push_back(column.name);
  return {ErrorCode::unknown_name,
          fmt::format("--phase: the result has no column '{}'", name),
          suggest(name, known),
          {},
          {}};
}

std::string in_a_plane(const result::Result& result, const FigureColumn& x, const FigureColumn& y) {
  constexpr double height = 720.0;
  Svg svg(width, height);
  const Plot plot{
      {left, 40.0}, width - left - 40.0, height - 100.0, roomy(range_of(x.values)), roomy(range_of(y.values))};
  svg.text({left, 22.0}, fmt::format("{}: {} over {}", title_of(result), y.name, x.name), "start", "#1c2430");
  draw_axes(svg, plot, true);
  svg.clip(plot.corner, plot.width, plot.height);
  auto legend = draw_surfaces(svg, result, plot, x, y);
  const Range time = time_range(result);
  const bool over_time = x.sort == ColumnSort::time;
  const double pixel = (time.to - time.from) / (over_time ? 2.0 * plot.width : 20000.0);
  const auto pieces = curve_pieces(result.trajectory, x.values, y.values, plot, pixel, false);
  draw_pieces(svg, pieces, curve_colors[0], 3.0);
  const bool any_slides =
      std::any_of(pieces.lines.begin(), pieces.lines.end(), [](const auto& piece) { return piece.sliding; });
  std::vector<LegendEntry> entries{{"solution", {curve_colors[0], 1.6}}};
  if (any_slides) entries.push_back({"sliding", {sliding_color, 3.0}});
  if (!pieces.jumps.empty()) entries.push_back({"jump", {jump_color, 1.0, "2 3"}});
  entries.push_back({"start", {}, LegendEntry::Mark::ring});
  entries.push_back({"end", {}, LegendEntry::Mark::disc});
  entries.insert(entries.end(), legend.begin(), legend.end());
  svg.clip(std::nullopt);
  const std::size_t rows = x.values.size();
  if (rows > 0 && std::isfinite(x.values[0]) && std::isfinite(y.values[0]))
    svg.disc(plot.place(x.values[0], y.values[0]), 5.0, "#ffffff", "#1c2430");
  if (rows > 0 && std::isfinite(x.values[rows - 1]) && std::isfinite(y.values[rows - 1]))
    svg.disc(plot.place(x.values[rows - 1], y.values[rows - 1]), 5.0, "#1c2430", "#1c2430");
  svg.text({left + plot.width / 2, height - 18.0}, x.name, "middle", "#1c2430");
  svg.text({18.0, 40.0 + plot.height / 2}, y.name, "middle", "#1c2430", -90.0);
  draw_legend(svg, entries, left, width - 40.0, height + 2.0);
  return svg.document(title_of(result));
}

}  // namespace

Expected<PhaseAxes> phase_axes(const result::Result& result, const std::string& text) {
  if (result.kept) return phase_axes(as_in_rows(result), text);
  const auto columns = figure_columns(result);
  const auto first = text.find(',');
  if (first == std::string::npos) {
    return tl::unexpected(Error{ErrorCode::invalid_option,
                                fmt::format("--phase '{}': two columns are needed", text),
                                "write them as X,Y",
                                {},
                                {}});
  }
  for (auto comma = first; comma != std::string::npos; comma = text.find(',', comma + 1)) {
    PhaseAxes axes{text.substr(0, comma), text.substr(comma + 1)};
    if (named(columns, axes.first) != nullptr && named(columns, axes.second) != nullptr) return axes;
  }
  const bool known = named(columns, text.substr(0, first)) != nullptr;
  return tl::unexpected(unknown_column(columns, known ? text.substr(first + 1) : text.substr(0, first)));
}

Expected<std::string> to_svg(const result::Result& result, const std::optional<PhaseAxes>& phase) {
  if (result.kept) return to_svg(as_in_rows(result), phase);
  if (!phase) return over_time(result);
  const auto columns = figure_columns(result);
  for (const auto& name : {phase->first, phase->second}) {
    if (named(columns, name) == nullptr) return tl::unexpected(unknown_column(columns, name));
  }
  return in_a_plane(result, *named(columns, phase->first), *named(columns, phase->second));
}

}  // namespace saltus::report
