// The segments of .nl texts, one letter each. Source: [gay2005].
#include <cmath>

#include <fmt/format.h>

#include "saltus/base/at.hpp"
#include "saltus/foreign/nl_file_internal.hpp"

namespace saltus::foreign {
namespace {

using casadi::SX;

/// `count` lines "index value"; each(i, value).
template <class Each>
void read_entries(NlLines& lines, long count, long indices, std::string_view what, Each each) {
  for (long i = 0; i < count && lines.advance(what); ++i) {
    const long index = lines.whole(0, fmt::format("{}, an index", what), 0, indices - 1);
    const double value = lines.number(1, what);
    if (!lines.failed()) each(at(index), value);
  }
}

SX read_linear(NlLines& lines, const NlNames& names, long count) {
  std::vector<SX> terms;
  const auto variables = static_cast<long>(names.variables.size());
  read_entries(lines, count, variables, "a coefficient", [&](std::size_t i, double value) {
    if (!std::isfinite(value)) lines.fail("an infinite coefficient");
    if (value != 0.0) terms.push_back(value * names.variables[i]);
  });
  SX sum = 0.0;
  for (const auto& term : terms) sum += term;
  return sum;
}

void read_nonlinear(NlLines& lines, const NlNames& names, long count, std::map<long, NlBody>& bodies) {
  const long i = lines.whole_behind_letter("the number of a row", 0, count - 1);
  auto& body = bodies[i];
  if (lines.letter() == 'O') {
    body.sense = lines.whole(1, "the sense of an objective (0 minimise, 1 maximise)", 0, 1) == 1 ? Sense::maximize
                                                                                                 : Sense::minimize;
  }
  if (body.nonlinear) lines.fail(fmt::format("a second segment {}", lines.word(0)));
  body.nonlinear = read_expression(lines, names);
}

void read_linear_part(NlLines& lines, const NlNames& names, long count, std::map<long, NlBody>& bodies, long& entries) {
  const long i = lines.whole_behind_letter("the number of a row", 0, count - 1);
  const long terms = lines.whole(1, "the number of linear terms", 0, lines.lines_left());
  auto& body = bodies[i];
  if (body.has_linear) lines.fail(fmt::format("a second segment {}", lines.word(0)));
  body.has_linear = true;
  entries += terms;
  body.linear = read_linear(lines, names, terms);
}

void read_defined(NlLines& lines, NlNames& names) {
  const auto first = static_cast<long>(names.variables.size());
  constexpr long last = 1L << 40;
  const long i = lines.whole_behind_letter("the number of a common expression, behind those of variables", first, last);
  const long terms = lines.whole(1, "the number of linear terms", 0, lines.lines_left());
  if (names.defined.contains(i)) lines.fail(fmt::format("a second segment V{}", i));
  const SX linear = read_linear(lines, names, terms);
  const SX nonlinear = read_expression(lines, names);
  if (!lines.failed()) names.defined.emplace(i, nonlinear + linear);
}

/// Suffixes say nothing about the problem, but those that state special ordered sets.
void read_suffix(NlLines& lines) {
  lines.whole_behind_letter("the kind of a suffix", 0, 63);
  const long count = lines.whole(1, "the number of values of a suffix", 0, lines.lines_left());
  const auto name = std::string(lines.word(2));
  bool states_sets = false;
  read_entries(lines, count, 1L << 40, "a value of a suffix",
               [&](std::size_t, double value) { states_sets = states_sets || value != 0.0; });
  if ((name == "sosno" || name == "sos") && states_sets) {
    lines.fail("special ordered sets (suffix " + name + ") are not available",
               "state the choice as a complementarity, or piecewise linear terms as expressions",
               ErrorCode::not_available);
  }
}

/// Lines of segment k: how many entries the columns of the Jacobian have.
void read_column_counts(NlLines& lines) {
  const long count = lines.whole_behind_letter("the number of columns", 0, lines.lines_left());
  for (long i = 0; i < count && lines.advance("the number of entries of a column"); ++i) {
    lines.whole(0, "the number of entries of a column", 0, 1L << 40);
  }
}

void read_start(NlLines& lines, NlFile& file) {
  const long count = lines.whole_behind_letter("the number of values of the start", 0, lines.lines_left());
  read_entries(lines, count, file.header.variables, "a value of the start", [&](std::size_t i, double value) {
    if (!std::isfinite(value)) lines.fail("an infinite value of the start");
    file.start[i] = value;
  });
}

void read_segment(NlLines& lines, NlFile& file) {
  const auto& header = file.header;
  switch (lines.letter()) {
    case 'C':
      return read_nonlinear(lines, file.names, header.constraints, file.constraints);
    case 'O':
      return read_nonlinear(lines, file.names, header.objectives, file.objectives);
    case 'J':
      return read_linear_part(lines, file.names, header.constraints, file.constraints, file.jacobian_entries);
    case 'G':
      return read_linear_part(lines, file.names, header.objectives, file.objectives, file.gradient_entries);
    case 'V':
      return read_defined(lines, file.names);
    case 'b':
      return read_bounds(lines, header.variables, file.variable_bounds);
    case 'r':
      return read_row_bounds(lines, file);
    case 'x':
      return read_start(lines, file);
    case 'd': {
      const long count = lines.whole_behind_letter("the number of values of the dual start", 0, lines.lines_left());
      return read_entries(lines, count, header.constraints, "a value of the dual start", [](std::size_t, double) {});
    }
    case 'k':
    case 'K':
      return read_column_counts(lines);
    case 'S':
      return read_suffix(lines);
    case 'F':  // what it declares is refused where it is used
      return;
    case 'L':
      return lines.fail("logical constraints are not available", "state them by complementarities or inequalities",
                        ErrorCode::not_available);
    default:
      lines.fail(fmt::format("expected a segment (one of C O V J G b r x d k S F), found '{}'", lines.word(0)));
  }
}

/// Whether all that the header promises was there: a file that was cut may well end with a whole segment.
void check_complete(NlLines& lines, const NlFile& file) {
  const auto& header = file.header;
  const auto missing = [&](const std::string& what) {
    lines.fail(fmt::format("the file ends without {}", what),
               "the file is not complete: write it again, or copy it as a whole");
  };
  const auto is_absent = [](const std::map<long, NlBody>& bodies, long i) {
    const auto found = bodies.find(i);
    return found == bodies.end() || !found->second.nonlinear;
  };
  if (file.variable_bounds.empty()) missing("a segment b, the bounds of the variables");
  if (file.row_bounds.empty() && header.constraints > 0) missing("a segment r, the bounds of the constraints");
  for (long i = 0; i < header.constraints && !lines.failed(); ++i) {
    if (is_absent(file.constraints, i)) missing(fmt::format("a segment C{}, the body of a constraint", i));
  }
  for (long i = 0; i < header.objectives && !lines.failed(); ++i) {
    if (is_absent(file.objectives, i)) missing(fmt::format("a segment O{}, an objective", i));
  }
  const auto compare = [&](const char* what, long promised, long found) {
    if (found < promised) missing(fmt::format("{} of the {} {} of its header", promised - found, promised, what));
  };
  compare("nonzeros of the Jacobian (segments J)", header.jacobian_entries, file.jacobian_entries);
  compare("nonzeros of gradients (segments G)", header.gradient_entries, file.gradient_entries);
}

}  // namespace

void read_segments(NlLines& lines, NlFile& file) {
  for (long i = 0; i < file.header.variables; ++i) file.names.variables.push_back(SX::sym(fmt::format("x_{}", i)));
  file.start.assign(at(file.header.variables), 0.0);
  while (!lines.failed() && lines.advance_if_any()) read_segment(lines, file);
  check_complete(lines, file);
}

}  // namespace saltus::foreign
