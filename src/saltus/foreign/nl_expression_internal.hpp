// Expressions of an AMPL .nl text: operators before their operands, one a line.
#pragma once

#include <span>
#include <unordered_map>
#include <vector>

#include <casadi/core/function.hpp>
#include <casadi/core/sx.hpp>

#include "saltus/foreign/nl_lines_internal.hpp"

namespace saltus::foreign {

/// Holds what stands behind `o`.
struct NlOperator {
  int code = 0;
  int operands = 0;  ///< -1: a list, whose length is the next line
  int fewest = 0;    ///< of a list
  casadi::SX (*make)(std::span<const casadi::SX> operands);
};

/// Returns nullptr if nobody knows the code.
[[nodiscard]] const NlOperator* nl_operator(long code);

/// Returns sum of |changes of slope| max(x - breakpoint, 0), zero where x is.
[[nodiscard]] casadi::SX piecewise_linear(const std::vector<double>& slopes, const std::vector<double>& breakpoints,
                                          const casadi::SX& x);

/// Holds the names that expressions may use.
struct NlNames {
  std::vector<casadi::SX> variables;
  std::unordered_map<long, casadi::SX> defined;  ///< common expressions, numbered behind the variables
};

/// Reads the expression that begins on the next line. Nesting is limited by memory only.
[[nodiscard]] casadi::SX read_expression(NlLines& lines, const NlNames& names);

}  // namespace saltus::foreign
