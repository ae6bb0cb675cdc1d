// Small .nl texts for tests.
#pragma once

#include <memory>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "saltus/foreign/parse.hpp"
#include "saltus/linalg/matrix.hpp"

namespace saltus::foreign {

/// The ten lines at the beginning.
inline std::string nl_header(int variables, int constraints, int objectives = 1, int jacobian = 0, int gradient = 0) {
  return fmt::format(
      "g3 1 1 0\t# problem small\n {} {} {} 0 0\t# vars, constraints, objectives, ranges, eqns\n 0 1 1 0\n 0 0\n 0 0 "
      "0\n"
      " 0 0 0 1\n 0 0 0 0 0\n {} {}\n 0 0\n 0 0 0 0 0\n",
      variables, constraints, objectives, jacobian, gradient);
}

/// Free variables, the objective is the expression.
inline std::string nl_objective(int variables, const std::string& expression) {
  std::string text = nl_header(variables, 0) + "O0 0\n" + expression + "b\n";
  for (int i = 0; i < variables; ++i) text += "3\n";
  return text;
}

inline std::unique_ptr<Problem> parsed(const std::string& text) {
  auto problem = parse(text, "small.nl");
  if (problem) return std::move(*problem);
  ADD_FAILURE() << to_text(problem.error()) << "\n" << text;
  return nullptr;
}

inline linalg::Vector point(std::initializer_list<double> values) { return values; }

inline linalg::Vector functions_at(Problem& problem, const linalg::Vector& w) {
  linalg::Vector c(problem.rows());
  problem.functions(w, c);
  return c;
}

}  // namespace saltus::foreign
