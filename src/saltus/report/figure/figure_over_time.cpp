#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <optional>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "saltus/report/figure/figure_columns_internal.hpp"
#include "saltus/report/figure/figure_legend_internal.hpp"
#include "saltus/report/text_columns_internal.hpp"

namespace saltus::report {
namespace {

/// Curves of one sort at most, as on the page.
constexpr std::size_t most_curves = 48, single_panels = 6, most_in_a_panel = 4;

/// Of events. Jumps are pale and not dotted: the dots of a curve that jumps there would fill the gaps.
constexpr Pen event_line{paper::mark, 0.6}, jump_line{"#b6d5da", 0.6}, alarm_line{paper::alarm, 1.5, "5 3"};
constexpr std::string_view crowd = "#e9ecf0";

using Curves = std::vector<FigureColumn>;

constexpr ColumnSort drawn_sorts[] = {ColumnSort::state, ColumnSort::output, ColumnSort::control, ColumnSort::alpha,
                                      ColumnSort::theta};

bool is_step(const result::Result& result, const FigureColumn& column) {
  return column.sort == ColumnSort::state && is_discrete(result.trajectory.t, column.values);
}

bool is_fraction(const FigureColumn& column) {
  return column.sort == ColumnSort::alpha || column.sort == ColumnSort::theta;
}

double span_of(const FigureColumn& column) {
  const Range range = range_of(column.values);
  return range.to - range.from;
}

/// That of the run; the default one where its method has none.
double absolute_tolerance(const result::Result& result) {
  for (const auto& [name, value] : result.options) {
    if (name != "simulate.atol") continue;
    if (const auto* atol = std::get_if<double>(&value)) return *atol;
  }
  return 1e-10;
}

Curves of_sort(const Curves& all, ColumnSort sort) {
  Curves columns;
  std::copy_if(all.begin(), all.end(), std::back_inserter(columns), [&](const auto& one) { return one.sort == sort; });
  return columns;
}

/// Those of a sort that move by more than their own rounding. What is below the tolerance of the run counts as that of
/// others, too: it is rounding if it is that of the largest among them.
Curves moving_of(const result::Result& result, const Curves& columns) {
  double largest = 0.0;
  for (const auto& column : columns) {
    const Range range = range_of(column.values);
    largest = std::max({largest, std::abs(range.from), std::abs(range.to)});
  }
  const double rounding = std::min(absolute_tolerance(result), 1e-15 * largest);
  Curves moving;
  std::copy_if(columns.begin(), columns.end(), std::back_inserter(moving),
               [&](const auto& one) { return moves(one.values) && span_of(one) > rounding; });
  return moving;
}

/// Columns of a sort that move, all if none does; of very many those that move most.
Curves moving_first(const result::Result& result, const Curves& all, ColumnSort sort) {
  Curves columns = of_sort(all, sort);
  if (auto moving = moving_of(result, columns); !moving.empty()) columns = std::move(moving);
  const std::size_t most = sort == ColumnSort::alpha || sort == ColumnSort::theta ? most_panels : most_curves;
  if (columns.size() <= most) return columns;
  std::vector<double> spans;
  for (const auto& column : columns) spans.push_back(span_of(column));
  std::sort(spans.begin(), spans.end(), std::greater());
  std::erase_if(columns, [&](const FigureColumn& column) { return span_of(column) < spans[most - 1]; });
  columns.resize(std::min(columns.size(), most));
  return columns;
}

/// Few curves have a panel each; many share them as long as none flattens another one, selections always.
std::vector<Curves> grouped(const Curves& columns) {
  constexpr double flattens = 20.0;
  std::vector<Curves> panels;
  const auto fits = [&](const Curves& panel, const FigureColumn& column) {
    if (panel.size() == most_in_a_panel) return false;
    if (is_fraction(column)) return true;
    Range hull = range_of(column.values);
    constexpr double none = std::numeric_limits<double>::infinity();
    double smallest = none;
    for (const auto& one : panel) {
      const Range range = range_of(one.values);
      hull = {std::min(hull.from, range.from), std::max(hull.to, range.to)};
      if (range.to > range.from) smallest = std::min(smallest, range.to - range.from);
    }
    if (const double span = span_of(column); span > 0.0) smallest = std::min(smallest, span);
    return smallest == none || hull.to - hull.from <= flattens * smallest;
  };
  for (const auto& column : columns) {
    const bool alone = columns.size() <= single_panels && !is_fraction(column);
    const auto panel =
        alone ? panels.end()
              : std::find_if(panels.begin(), panels.end(), [&](const Curves& one) { return fits(one, column); });
    if (panel == panels.end()) {
      panels.push_back({column});
    } else {
      panel->push_back(column);
    }
  }
  return panels;
}

/// What the page draws first: what moves, by sort, discrete states last.
std::vector<Curves> first_panels(const result::Result& result) {
  const auto all = figure_columns(result);
  std::vector<Curves> panels;
  Curves steps;
  for (const auto sort : drawn_sorts) {
    auto columns = moving_first(result, all, sort);
    std::copy_if(columns.begin(), columns.end(), std::back_inserter(steps),
                 [&](const auto& one) { return is_step(result, one); });
    std::erase_if(columns, [&](const auto& one) { return is_step(result, one); });
    for (auto& group : grouped(columns)) panels.push_back(std::move(group));
  }
  for (auto& group : grouped(steps)) panels.push_back(std::move(group));
  return panels;
}

std::size_t count_of(const std::vector<Curves>& panels) {
  std::size_t count = 0;
  for (const auto& panel : panels) count += panel.size();
  return count;
}

/// Columns that move, without the time.
std::size_t count_of_moving(const result::Result& result) {
  const auto all = figure_columns(result);
  std::size_t count = 0;
  for (const auto sort : drawn_sorts) count += moving_of(result, of_sort(all, sort)).size();
  return count;
}

/// What is seen of events, and of the bands.
struct Shown {
  bool events = false, jumps = false, crowds = false, not_unique = false;
  DrawnModes modes;
};

/// Events as thin lines from the top to the bottom, those that are not unique always. Of many those that are close
/// together are grey areas: one line for some pixels would look like a slower switching.
void draw_events(Svg& svg, const result::Result& result, const Plot& time, double top, double bottom, Shown& shown) {
  const double apart = result.events.size() > 200 ? 6.0 : 0.0;
  std::vector<double> places;
  for (std::size_t i = 0; i < result.events.size(); ++i) places.push_back(time.place(result.events.t(i), 0.0).x);
  const auto line = [&](std::size_t i, const Pen& pen) { svg.path({{places[i], top}, {places[i], bottom}}, pen); };
  for (std::size_t i = 0, last = 0; i < places.size(); i = last + 1) {
    for (last = i; last + 1 < places.size() && places[last + 1] - places[last] < apart;) ++last;
    if (last > i) {
      svg.rectangle({places[i], top}, std::max(1.0, places[last] - places[i]), bottom - top, crowd);
      shown.crowds = true;
    } else if (result.events.unique(i) != false) {
      const bool jump = is_jump(result.events.kind(i));
      line(i, jump ? jump_line : event_line);
      (jump ? shown.jumps : shown.events) = true;
    }
  }
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (result.events.unique(i) != false) continue;
    line(i, alarm_line);
    shown.not_unique = true;
  }
}

/// Of results, the bands and the lines of events.
std::vector<LegendEntry> legend_over_time(const FigureOverlays& overlays, const Shown& shown) {
  std::vector<LegendEntry> entries;
  if (!overlays.empty()) entries.push_back({"first result", {paper::curves[0], 1.6}});
  for (const auto& overlay : overlays) entries.push_back({overlay.label, overlay.pen});
  const auto add = [&](bool wanted, std::string_view name, const Pen& pen, LegendEntry::Mark mark) {
    if (wanted) entries.push_back({std::string(name), pen, mark});
  };
  using enum LegendEntry::Mark;
  add(shown.modes.minus, "psi < 0", {paper::minus}, box);
  add(shown.modes.sliding, "sliding", {paper::sliding}, box);
  add(shown.modes.plus, "psi > 0", {paper::plus}, box);
  add(shown.modes.chattering, "chattering", {hatched}, box);
  add(shown.events, "event", {event_line.color, 1.0}, line);
  add(shown.jumps, "jump", {jump_line.color, 1.0}, line);
  add(shown.crowds, "events closer than lines", {crowd}, box);
  add(shown.not_unique, "not unique", alarm_line, line);
  return entries;
}

std::string paler(std::string_view color) {
  std::string pale = "#";
  for (std::size_t i = 1; i + 1 < color.size(); i += 2) {
    const int part = std::stoi(std::string(color.substr(i, 2)), nullptr, 16);
    pale += fmt::format("{:02x}", 255 - 3 * (255 - part) / 10);
  }
  return pale;
}

/// Where a curve jumps to and fro within pixels: between which values, and its mean there.
void draw_chattering(Svg& svg, const std::vector<Chattering>& pixels, const Plot& plot, std::string_view color) {
  std::vector<Point> mean;
  const auto fill = paler(color);
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const auto& [begin, end, from, to, low, high, middle] = pixels[i];
    svg.area({plot.place(from, low), plot.place(to, low), plot.place(to, high), plot.place(from, high)}, fill);
    mean.push_back(plot.place(from, middle));
    mean.push_back(plot.place(to, middle));
    if (i + 1 < pixels.size() && pixels[i + 1].from == to) continue;
    svg.path(mean, {color, 1.6});
    mean.clear();
  }
}

/// The impulse of a contact is there at one instant: no line leads from it to the row behind.
bool is_impulse(const result::Result& result, const FigureColumn& column) {
  return column.sort == ColumnSort::output &&
         std::any_of(result.contacts.begin(), result.contacts.end(),
                     [&](const std::string& contact) { return column.name == fmt::format("impulse({})", contact); });
}

void draw_stems(Svg& svg, const std::vector<double>& t, const std::vector<double>& values, const Plot& plot,
                std::string_view color) {
  if (t.empty()) return;
  std::vector<Point> line{plot.place(t.front(), 0.0)};
  for (std::size_t row = 0; row < t.size(); ++row) {
    if (values[row] == 0.0 || !std::isfinite(values[row])) continue;
    for (const double value : {0.0, values[row], 0.0}) line.push_back(plot.place(t[row], value));
  }
  line.push_back(plot.place(t.back(), 0.0));
  svg.path(line, {color, 1.6});
}

void draw_curve(Svg& svg, const result::Result& result, const FigureColumn& column, const Plot& plot, const Pen& pen) {
  if (is_impulse(result, column)) return draw_stems(svg, result.trajectory.t, column.values, plot, pen.color);
  const double pixel = (plot.x.to - plot.x.from) / plot.width;
  const auto& t = result.trajectory.t;
  const auto chattering = chattering_pixels(t, column.values, pixel, 1e-5 * span_of(column));
  draw_chattering(svg, chattering, plot, pen.color);
  const bool steps = is_step(result, column);
  draw_pieces(svg, curve_pieces(result.trajectory, t, column.values, plot, pixel / 2, steps, chattering), pen,
              pen.color, 0.0);
}

/// Beside a panel: the unit on a line of its own if it is long, and behind it what the model says.
std::vector<std::string> lines_beside(const FigureColumn& column, bool alone) {
  const auto title = title_of(column);
  const auto& [unit, label] = column.caption;
  std::vector<std::string> lines{title};
  if (alone && !unit.empty() && width(title) > letters_beside) lines = {column.name, fmt::format("[{}]", unit)};
  if (alone && !label.empty()) lines.push_back(label);
  return lines;
}

/// Of the curves in a panel, those of other results among them.
Range hull_of(const Curves& curves, const FigureOverlays& overlays) {
  if (std::all_of(curves.begin(), curves.end(), is_fraction)) return {-0.06, 1.06};
  Range range{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  const auto widen = [&](const FigureColumn& column) {
    const Range one = range_of(column.values);
    range = {std::min(range.from, one.from), std::max(range.to, one.to)};
  };
  for (const auto& column : curves) {
    widen(column);
    for (const auto& overlay : overlays) {
      if (const auto* other = overlay.like(column)) widen(*other);
    }
  }
  return roomy(range);
}

void draw_panel(Svg& svg, const result::Result& result, const Curves& curves, const FigureOverlays& overlays, Plot plot,
                bool last) {
  plot.y = hull_of(curves, overlays);
  draw_axes(svg, plot, last);
  std::vector<std::pair<std::string, std::string_view>> lines;
  for (std::size_t i = 0; i < curves.size(); ++i) {
    const std::size_t place = curves.size() == 1 ? static_cast<std::size_t>(curves[i].sort) : i;
    const auto color = paper::curves[place % paper::curves.size()];
    svg.clip(plot.corner, plot.width, plot.height);
    draw_curve(svg, result, curves[i], plot, {color, 1.6});
    for (const auto& overlay : overlays) {
      if (const auto* other = overlay.like(curves[i])) draw_curve(svg, overlay.result, *other, plot, overlay.pen);
    }
    svg.clip(std::nullopt);
    for (const auto& line : lines_beside(curves[i], curves.size() == 1)) lines.emplace_back(line, color);
  }
  const double step = std::min(16.0, plot.height / static_cast<double>(lines.size()));
  double y = plot.corner.y + plot.height / 2 + 4.0 - step * static_cast<double>(lines.size() - 1) / 2;
  for (const auto& [line, color] : lines) {
    svg.text({plot.corner.x + plot.width + 8.0, y}, shortened(line, letters_beside), "start", color);
    y += step;
  }
}

/// Room for the longest line.
double room_beside(const result::Result& result, const std::vector<Curves>& panels) {
  std::size_t letters = 9;
  for (const auto& name : result.switching_functions) letters = std::max(letters, width(name));
  for (const auto& panel : panels) {
    for (const auto& column : panel) {
      for (const auto& line : lines_beside(column, panel.size() == 1)) letters = std::max(letters, width(line));
    }
  }
  return 20.0 + 7.5 * static_cast<double>(std::min(letters, letters_beside));
}

}  // namespace

std::string draw_over_time(const result::Result& result, const std::vector<FigureColumn>& columns,
                           const FigureOverlays& overlays) {
  std::vector<Curves> panels;
  for (const auto& column : columns) panels.push_back({column});
  if (panels.empty()) panels = first_panels(result);
  if (columns.empty()) panels.resize(std::min(panels.size(), most_panels));
  const std::size_t moving = columns.empty() ? count_of_moving(result) : 0, drawn = count_of(panels);
  const std::size_t left_out = moving - std::min(moving, drawn);
  const double gap = 12.0, high = panels.size() > 6 ? 92.0 : 130.0;
  const auto bands = banded(result);
  const double height =
      44.0 + 20.0 * static_cast<double>(bands.size()) + static_cast<double>(panels.size()) * (high + gap) + 56.0;
  Svg svg(paper::width, height);
  const double wide = paper::width - paper::left - room_beside(result, panels);
  Plot plot{{paper::left, 40.0}, wide, high, time_range(result, overlays), {0.0, 1.0}};
  svg.text({paper::left, 22.0},
           title_line(result, fmt::format(": {} to t = {:.6g}{}", result::name(result.status.termination),
                                          result.status.time_reached,
                                          left_out > 0 ? fmt::format(", {} more columns", left_out) : "")),
           "start", paper::text);
  Shown shown;
  draw_events(svg, result, plot, 32.0, height - 56.0, shown);
  plot.corner.y = draw_bands(svg, result, bands, plot, 40.0, shown.modes);
  for (std::size_t i = 0; i < panels.size(); ++i, plot.corner.y += high + gap)
    draw_panel(svg, result, panels[i], overlays, plot, i + 1 == panels.size());
  svg.text({paper::left + plot.width / 2, height - 14.0}, "t", "middle", paper::text);
  draw_legend(svg, legend_over_time(overlays, shown), paper::left, paper::width - 20.0, height + 2.0);
  return svg.document(heading_of(result));
}

}  // namespace saltus::report
