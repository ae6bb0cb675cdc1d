// What the lines of a figure mean, below it.
#pragma once

#include <string>
#include <vector>

#include "saltus/report/figure/svg_internal.hpp"
#include "saltus/result/result.hpp"

namespace saltus::report {

struct LegendEntry {
  enum class Mark { line, box, ring, disc, point, cross };
  std::string name;
  Pen pen;
  Mark mark = Mark::line;
};

/// Returns whether the state jumps at events of a kind.
[[nodiscard]] bool is_jump(result::EventKind kind);

/// Says what sorts of events there are; those that are not unique count as that only.
struct EventSorts {
  bool switches = false, jumps = false, not_unique = false;
};
[[nodiscard]] EventSorts sorts_of(const result::Events& events);

/// Draws entries side by side, in as many lines as they need, from `top` on; the picture grows by them.
/// @param left, right  ends of the lines
void draw_legend(Svg& svg, const std::vector<LegendEntry>& entries, double left, double right, double top);

}  // namespace saltus::report
