#include <algorithm>
#include <string_view>

#include <fmt/format.h>

#include "saltus/report/figure/figure_legend_internal.hpp"
#include "saltus/report/text_columns_internal.hpp"

namespace saltus::report {
namespace {

constexpr std::string_view ink = "#1c2430";
constexpr double swatch = 26.0, line_height = 20.0;

void draw_mark(Svg& svg, const LegendEntry& entry, Point at) {
  switch (entry.mark) {
    case LegendEntry::Mark::line:
      svg.path({{at.x, at.y}, {at.x + swatch, at.y}}, entry.pen);
      break;
    case LegendEntry::Mark::box:
      svg.rectangle({at.x, at.y - 5.0}, swatch, 10.0, entry.pen.color);
      break;
    case LegendEntry::Mark::ring:
      svg.disc({at.x + swatch / 2, at.y}, 5.0, "#ffffff", ink);
      break;
    case LegendEntry::Mark::disc:
      svg.disc({at.x + swatch / 2, at.y}, 5.0, ink, ink);
      break;
    case LegendEntry::Mark::point:
      svg.disc({at.x + swatch / 2, at.y}, 3.0, entry.pen.color, "#ffffff");
      break;
    case LegendEntry::Mark::cross:
      draw_cross(svg, {at.x + swatch / 2, at.y}, entry.pen);
      break;
  }
}

}  // namespace

bool is_jump(result::EventKind kind) { return kind == result::EventKind::jump || kind == result::EventKind::impact; }

EventSorts sorts_of(const result::Events& events) {
  EventSorts sorts;
  for (std::size_t i = 0; i < events.size(); ++i) {
    auto& sort = events.unique(i) == false ? sorts.not_unique : is_jump(events.kind(i)) ? sorts.jumps : sorts.switches;
    sort = true;
  }
  return sorts;
}

void draw_legend(Svg& svg, const std::vector<LegendEntry>& entries, double left, double right, double top) {
  constexpr std::size_t most = 24, longest = 40;
  constexpr double letter = 7.0, gap = 18.0;
  if (entries.empty()) return;
  double x = left, y = top;
  for (std::size_t i = 0; i < std::min(most, entries.size()); ++i) {
    const bool last = i + 1 == most && entries.size() > most;
    const auto name = last ? fmt::format("and {} more", entries.size() - i) : shortened(entries[i].name, longest);
    const double wide = swatch + 6.0 + letter * static_cast<double>(width(name));
    if (x > left && x + wide > right) x = left, y += line_height;
    if (!last) draw_mark(svg, entries[i], {x, y});
    svg.text({x + swatch + 6.0, y + 4.0}, name, "start", ink);
    x += wide + gap;
  }
  svg.make_taller(y + line_height - top);
}

}  // namespace saltus::report
