// What the lines of a figure mean, below it.
#pragma once

#include <string>
#include <vector>

#include "saltus/report/figure/svg_internal.hpp"

namespace saltus::report {

struct LegendEntry {
  enum class Mark { line, box, ring, disc };
  std::string name;
  Pen pen;
  Mark mark = Mark::line;
};

/// Entries side by side, in as many lines as they need, from `top` on; the picture grows by them.
/// @param left, right  ends of the lines
void draw_legend(Svg& svg, const std::vector<LegendEntry>& entries, double left, double right, double top);

}  // namespace saltus::report
