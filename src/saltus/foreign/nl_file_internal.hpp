// An AMPL .nl text as it stands: header, segments, bodies as expressions.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "saltus/foreign/nl_expression_internal.hpp"
#include "saltus/foreign/nl_lines_internal.hpp"
#include "saltus/foreign/statement.hpp"

namespace saltus::foreign {

struct NlHeader {
  long variables = 0, constraints = 0, objectives = 0;
  long jacobian_entries = 0, gradient_entries = 0;  ///< of segments J and G, all together
};

/// Holds the line of segment b or r. Type 5 of r: the row complements a variable.
struct NlBound {
  double lower = -infinity;
  double upper = infinity;
  int complements = -1;         ///< variable, from 0
  bool has_lower_side = false;  ///< the variable's lower bound takes part, 1 of k
  bool has_upper_side = false;  ///< 2 of k
  int line = 0;
};

/// Holds a row or an objective: its nonlinear part, and its linear one.
struct NlBody {
  std::optional<casadi::SX> nonlinear;
  casadi::SX linear = 0.0;
  bool has_linear = false;
  Sense sense = Sense::minimize;
};

struct NlFile {
  NlHeader header;
  NlNames names;
  std::map<long, NlBody> constraints, objectives;
  std::vector<NlBound> variable_bounds, row_bounds;
  std::vector<double> start;
  long jacobian_entries = 0, gradient_entries = 0;  ///< that were read
  std::vector<std::string> notes;
};

/// Reads the ten lines at the beginning.
[[nodiscard]] NlHeader read_header(NlLines& lines);
/// Reads everything behind the header; errors stay in `lines`.
void read_segments(NlLines& lines, NlFile& file);
/// Reads segments b and r, whose first line has been read.
void read_bounds(NlLines& lines, long count, std::vector<NlBound>& bounds);
void read_row_bounds(NlLines& lines, NlFile& file);

}  // namespace saltus::foreign
