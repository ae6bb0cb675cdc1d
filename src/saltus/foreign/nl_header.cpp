#include <fmt/format.h>

#include "saltus/foreign/nl_file_internal.hpp"

namespace saltus::foreign {
namespace {

constexpr long most = 1L << 30;

void read_first_line(NlLines& lines) {
  if (!lines.advance("the first line of an .nl file, which begins with g")) return;
  if (lines.letter() == 'b') {
    lines.fail("this .nl file is binary", "write it as text: in AMPL `write gNAME;`, in Pyomo and JuMP it is text",
               ErrorCode::not_available);
  } else if (lines.letter() != 'g') {
    lines.fail(fmt::format("expected an .nl file, whose first line begins with g, found '{}'", lines.word(0)));
  }
  if (lines.word(0).size() > 1) lines.whole_behind_letter("the number of options", 0, 9);
}

long count(NlLines& lines, std::size_t word, std::string_view what) {
  return word < lines.words() ? lines.whole(word, what, 0, most) : 0;
}

void refuse_integers(NlLines& lines) {
  long integers = 0;
  for (std::size_t i = 0; i < 5; ++i) integers += count(lines, i, "a number of discrete variables");
  if (integers == 0 || lines.failed()) return;
  lines.fail(fmt::format("{} of the variables are binary or integer, which is not available", integers),
             "relax them (in AMPL `option relax_integrality 1;`), or state the choice as a complementarity",
             ErrorCode::not_available);
}

}  // namespace

NlHeader read_header(NlLines& lines) {
  read_first_line(lines);
  NlHeader header;
  if (!lines.advance("line 2 of the header: variables, constraints, objectives")) return header;
  header.variables = lines.whole(0, "the number of variables", 1, most);
  header.constraints = lines.whole(1, "the number of constraints", 0, most);
  header.objectives = lines.whole(2, "the number of objectives", 0, most);
  if (count(lines, 5, "the number of logical constraints") > 0) {
    lines.fail("logical constraints are not available", "state them by complementarities or inequalities",
               ErrorCode::not_available);
  }
  // Every variable and every row has its line in segments b and r, so that a wrong number costs no memory.
  if (!lines.failed() && header.variables + header.constraints > lines.lines_left()) {
    lines.fail(fmt::format("the header promises {} variables and {} constraints, but only {} lines follow",
                           header.variables, header.constraints, lines.lines_left()),
               "the file is not complete: write it again, or copy it as a whole");
  }
  for (int line = 3; line <= 10 && lines.advance(fmt::format("line {} of the header", line)); ++line) {
    const auto what = fmt::format("a number in line {} of the header", line);
    if (line == 7) {
      refuse_integers(lines);
    } else {
      for (std::size_t i = 0; i < lines.words(); ++i) count(lines, i, what);
    }
    if (line == 8) {
      header.jacobian_entries = count(lines, 0, what);
      header.gradient_entries = count(lines, 1, what);
    }
  }
  return header;
}

}  // namespace saltus::foreign
