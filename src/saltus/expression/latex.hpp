// Expressions as LaTeX, for notebooks and pages with formulas.
#pragma once

#include <string>
#include <string_view>

#include "saltus/expression/syntax_tree.hpp"

namespace saltus::expression {

/// Puts a backslash before underscores, which are commands of LaTeX.
[[nodiscard]] std::string latex_escaped(std::string_view text);

/// Writes a name as LaTeX: Greek letters as such, digits at its end and what follows `_` as indices, words upright.
[[nodiscard]] std::string latex_name(const std::string& name);

/// Writes a tree as LaTeX: quotients as fractions, if() as cases, functions by their commands. Cost: linear in its
/// text.
[[nodiscard]] std::string to_latex(const Node& node);

}  // namespace saltus::expression
