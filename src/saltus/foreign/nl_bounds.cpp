// Segments b and r of .nl texts.
#include <fmt/format.h>

#include "saltus/base/at.hpp"
#include "saltus/foreign/nl_file_internal.hpp"

namespace saltus::foreign {
namespace {

NlBound bound_of(NlLines& lines, long type) {
  NlBound bound;
  if (type == 0 || type == 2 || type == 4) bound.lower = lines.number(1, "a lower bound");
  if (type == 0) bound.upper = lines.number(2, "an upper bound");
  if (type == 1) bound.upper = lines.number(1, "an upper bound");
  if (type == 4) bound.upper = bound.lower;
  if (bound.lower > bound.upper) {
    lines.fail(fmt::format("the lower bound {} is above the upper bound {}", bound.lower, bound.upper));
  } else if (bound.lower == infinity || bound.upper == -infinity) {
    lines.fail("a lower bound of +infinity, or an upper one of -infinity: there is no such number");
  }
  bound.line = lines.line();
  return bound;
}

NlBound complementarity_of(NlLines& lines, long variables) {
  NlBound bound;
  const long sides = lines.whole(1, "the kind of a complementarity", 0, 3);
  bound.complements = static_cast<int>(lines.whole(2, "the variable of a complementarity", 1, variables) - 1);
  bound.has_lower_side = sides % 2 == 1;
  bound.has_upper_side = sides >= 2;
  bound.line = lines.line();
  return bound;
}

}  // namespace

void read_bounds(NlLines& lines, long count, std::vector<NlBound>& bounds) {
  if (!bounds.empty()) lines.fail("a second segment b: bounds of the variables are there already");
  for (long i = 0; i < count && lines.advance(fmt::format("the bounds of variable {} of {}", i + 1, count)); ++i) {
    bounds.push_back(bound_of(lines, lines.whole(0, "the type of a bound", 0, 4)));
  }
}

void read_row_bounds(NlLines& lines, NlFile& file) {
  const long count = file.header.constraints;
  if (!file.row_bounds.empty()) lines.fail("a second segment r: bounds of the constraints are there already");
  for (long i = 0; i < count && lines.advance(fmt::format("the bounds of constraint {} of {}", i + 1, count)); ++i) {
    const long type = lines.whole(0, "the type of a constraint", 0, 5);
    file.row_bounds.push_back(type == 5 ? complementarity_of(lines, file.header.variables) : bound_of(lines, type));
  }
}

}  // namespace saltus::foreign
