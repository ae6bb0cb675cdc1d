// Problems with complementarities in files of others.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "saltus/base/error.hpp"
#include "saltus/foreign/problem.hpp"

namespace saltus::foreign {

/// Holds what AMPL writes beside an .nl file, one name a line: NAME.col and NAME.row. Empty where there are none.
struct Names {
  std::string columns;
  std::string rows;
};

/// Reads a problem from the text of a file. The format is known by its content: AMPL .nl text; JSON of NOSBENCH
/// (`augmented_objective_fun`) or of mpecopt's MacMPEC (`f_fun`), functions serialised by CasADi.
/// @param file  its name, for messages
/// @return the problem; or what is wrong where, what was expected, and what to do. Fails (not_available) for integer
///         variables, functions of libraries, logical constraints, functions of a newer CasADi.
/// Cost: derivatives are made, linear in the size of the expressions.
[[nodiscard]] Expected<std::unique_ptr<Problem>> parse(const std::string& text, const std::string& file,
                                                       const Names& names = {});

}  // namespace saltus::foreign
