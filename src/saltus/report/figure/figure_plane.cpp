#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "saltus/report/figure/figure_columns_internal.hpp"
#include "saltus/report/figure/figure_legend_internal.hpp"

namespace saltus::report {
namespace {

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
    const Pen pen{paper::curves[5 - n++ % 5], 1.2, surface.role == result::SurfaceRole::jump ? "6 2 2 2" : "7 3"};
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

/// Arrows of one length on paper, which say where solutions go.
void draw_arrows(Svg& svg, const Plot& plot, const result::Arrows& arrows, bool swapped, const Pen& pen) {
  constexpr double length = 17.0, head = 0.7, half = 0.15;
  for (std::size_t i = 0; i < arrows.x.size(); ++i) {
    const double x = swapped ? arrows.y[i] : arrows.x[i], y = swapped ? arrows.x[i] : arrows.y[i];
    const double along_x = swapped ? arrows.dy[i] : arrows.dx[i], along_y = swapped ? arrows.dx[i] : arrows.dy[i];
    const double dx = along_x * plot.width / (plot.x.to - plot.x.from);
    const double dy = -along_y * plot.height / (plot.y.to - plot.y.from);
    const double size = std::hypot(dx, dy);
    if (!(size > 0.0) || !std::isfinite(size)) continue;
    const Point from = plot.place(x, y);
    const auto at = [&](double along, double across) {
      return Point{from.x + length * (along * dx - across * dy) / size,
                   from.y + length * (along * dy + across * dx) / size};
    };
    svg.path({at(0.0, 0.0), at(1.0, 0.0), at(head, half), at(1.0, 0.0), at(head, -half)}, pen);
  }
}

/// Only where the axes are the two states of the model; whether it is drawn.
bool draw_field(Svg& svg, const result::Result& result, const Plot& plot, const FigureColumn& x,
                const FigureColumn& y) {
  const bool of_states = x.sort == ColumnSort::state && y.sort == ColumnSort::state && x.index != y.index;
  if (!result.vector_field || !of_states || result.states.size() != 2) return false;
  const bool swapped = x.index == 1;
  draw_arrows(svg, plot, result.vector_field->free, swapped, {paper::axis, 0.8});
  draw_arrows(svg, plot, result.vector_field->sides, swapped, {paper::mark, 1.1});
  draw_arrows(svg, plot, result.vector_field->sliding, swapped, {paper::sliding, 2.0});
  return true;
}

/// Where an event stands on an axis: behind it.
double coordinate(const result::Event& event, const FigureColumn& column, const std::vector<double>& t) {
  if (column.sort == ColumnSort::time) return event.t;
  if (column.sort == ColumnSort::state && column.index < event.x_after.size()) return event.x_after[column.index];
  const auto behind = std::upper_bound(t.begin(), t.end(), event.t);
  return behind == t.begin() ? std::nan("") : column.values[static_cast<std::size_t>(behind - t.begin()) - 1];
}

/// Events as points, of those that would lie on each other the first; those that are not unique as crosses, all of
/// them.
void draw_event_points(Svg& svg, const result::Result& result, const Plot& plot, const FigureColumn& x,
                       const FigureColumn& y) {
  constexpr double apart = 3.0;
  std::set<std::pair<long, long>> taken;
  for (const auto& event : result.events) {
    const Point at = plot.place(coordinate(event, x, result.trajectory.t), coordinate(event, y, result.trajectory.t));
    if (!std::isfinite(at.x) || !std::isfinite(at.y)) continue;
    if (event.unique == false) {
      draw_cross(svg, at, {paper::alarm, 2.5});
      continue;
    }
    if (!taken.emplace(std::lround(at.x / apart), std::lround(at.y / apart)).second) continue;
    svg.disc(at, 3.0, is_jump(event.kind) ? paper::jump : paper::mark, "#ffffff");
  }
}

std::vector<LegendEntry> legend_of_plane(const result::Result& result, const CurvePieces& pieces, bool with_field) {
  std::vector<LegendEntry> entries{{"solution", {paper::curves[0], 1.6}}};
  const auto sorts = sorts_of(result.events);
  if (std::any_of(pieces.lines.begin(), pieces.lines.end(), [](const auto& piece) { return piece.sliding; }))
    entries.push_back({"sliding", {paper::sliding, 3.0}});
  if (sorts.jumps || !pieces.jumps.empty()) entries.push_back({"jump", {paper::jump, 1.0, "2 3"}});
  if (sorts.switches) entries.push_back({"event", {paper::mark}, LegendEntry::Mark::point});
  if (sorts.not_unique) entries.push_back({"not unique", {paper::alarm, 2.5}, LegendEntry::Mark::cross});
  entries.push_back({"start", {}, LegendEntry::Mark::ring});
  entries.push_back({"end", {}, LegendEntry::Mark::disc});
  if (with_field) entries.push_back({"vector field", {paper::axis, 0.8}});
  return entries;
}

std::string axis_text(const FigureColumn& column) {
  return column.caption.label.empty() ? title_of(column) : fmt::format("{} {}", column.caption.label, title_of(column));
}

/// Of a column in all results.
Range axis_range(const FigureColumn& column, const FigureOverlays& overlays) {
  Range hull = range_of(column.values);
  for (const auto& overlay : overlays) {
    const auto* other = overlay.like(column);
    if (other == nullptr) continue;
    const Range own = range_of(other->values);
    hull = {std::min(hull.from, own.from), std::max(hull.to, own.to)};
  }
  return roomy(hull);
}

CurvePieces orbit_pieces(const result::Result& result, const FigureColumn& x, const FigureColumn& y, const Plot& plot) {
  const Range time = time_range(result);
  const bool over_time = x.sort == ColumnSort::time;
  const double pixel = (time.to - time.from) / (over_time ? 2.0 * plot.width : 20000.0);
  auto pieces = curve_pieces(result.trajectory, x.values, y.values, plot, pixel, false);
  round_corners(pieces);
  return pieces;
}

/// Returns those that have both columns.
std::vector<LegendEntry> draw_overlays(Svg& svg, const FigureOverlays& overlays, const Plot& plot,
                                       const FigureColumn& x, const FigureColumn& y) {
  std::vector<LegendEntry> drawn;
  for (const auto& overlay : overlays) {
    const auto *own_x = overlay.like(x), *own_y = overlay.like(y);
    if (own_x == nullptr || own_y == nullptr) continue;
    draw_pieces(svg, orbit_pieces(overlay.result, *own_x, *own_y, plot), overlay.pen, overlay.pen.color, 0.0);
    drawn.push_back({overlay.label, overlay.pen});
  }
  return drawn;
}

}  // namespace

std::string draw_in_a_plane(const result::Result& result, const FigureColumn& x, const FigureColumn& y,
                            const FigureOverlays& overlays) {
  constexpr double height = 720.0;
  Svg svg(paper::width, height);
  const Plot plot{{paper::left, 40.0},
                  paper::width - paper::left - 40.0,
                  height - 100.0,
                  axis_range(x, overlays),
                  axis_range(y, overlays)};
  svg.text({paper::left, 22.0}, title_line(result, fmt::format(": {} over {}", y.name, x.name)), "start", paper::text);
  draw_axes(svg, plot, true);
  svg.clip(plot.corner, plot.width, plot.height);
  const bool with_field = draw_field(svg, result, plot, x, y);
  const auto surfaces = draw_surfaces(svg, result, plot, x, y);
  const auto pieces = orbit_pieces(result, x, y, plot);
  draw_pieces(svg, pieces, {paper::curves[0], 1.6}, paper::jump, 3.0);
  const auto others = draw_overlays(svg, overlays, plot, x, y);
  draw_event_points(svg, result, plot, x, y);
  svg.clip(std::nullopt);
  const std::size_t rows = x.values.size();
  const auto end = [&](std::size_t row, std::string_view fill) {
    if (row < rows && std::isfinite(x.values[row]) && std::isfinite(y.values[row]))
      svg.disc(plot.place(x.values[row], y.values[row]), 5.0, fill, paper::text);
  };
  end(0, "#ffffff");
  end(rows - 1, paper::text);
  svg.text({paper::left + plot.width / 2, height - 18.0}, axis_text(x), "middle", paper::text);
  svg.text({18.0, 40.0 + plot.height / 2}, axis_text(y), "middle", paper::text, -90.0);
  auto legend = legend_of_plane(result, pieces, with_field);
  legend.insert(legend.begin() + 1, others.begin(), others.end());
  legend.insert(legend.end(), surfaces.begin(), surfaces.end());
  draw_legend(svg, legend, paper::left, paper::width - 40.0, height + 2.0);
  return svg.document(heading_of(result));
}

}  // namespace saltus::report
