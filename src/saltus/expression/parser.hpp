// Text of an expression -> syntax tree with source positions.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "saltus/base/error.hpp"
#include "saltus/expression/syntax_tree.hpp"

namespace saltus::expression {

/// Parses one expression.
/// Precedence, loosest first: or, and, not, comparisons (non-associative), + -, * /, signs, ^ (right associative; 2^-1
/// is allowed). Numbers and conditions are not told apart here, the model does that.
/// Checks names of functions and their number of arguments; does not know which names exist otherwise.
/// @param text   the expression; may run over several lines
/// @param start  position of its first character in its file, unknown (0) counts as 1. Columns count bytes; only the
///               first line of the text is offset by the column
/// @param extra_functions  names of tables of the model, which are functions of one argument
/// @param declared  names of values; one that a function has is a name, too: it is refused where it is declared
/// @return the tree, or a parse_failure / unknown_name with position, what was expected and a remedy.
///         Refused are texts beyond 64 KiB, nesting deeper than 200 levels and trees higher than 1000 nodes (a sum of
///         more than 1000 terms without parentheses), so that recursion over a tree is safe.
[[nodiscard]] Expected<NodePtr> parse(std::string_view text, const SourceLocation& start,
                                      const std::vector<std::string>& extra_functions = {},
                                      const std::vector<std::string>& declared = {});

/// Returns a number as a tree, e.g. for a bare number in a model file; may be negative, as it may not in a parsed tree.
[[nodiscard]] NodePtr number(double value, const SourceLocation& location);

/// Returns a tree in place of one that could not be read: a name without letters, which nobody can give.
[[nodiscard]] NodePtr unreadable(const SourceLocation& location);

/// Returns the text of a tree without spaces (but around the words and, or, not), with the parentheses that were
/// written and those that are needed, numbers as they were written (or, if no text states them, the shortest ones that
/// read back the same). Names switching functions. Parsing it gives an equal tree, if the tree was parsed.
[[nodiscard]] std::string to_text(const Node& node);

/// Writes the same, with spaces where people put them: around + - and comparisons, behind commas.
[[nodiscard]] std::string to_spaced_text(const Node& node);

/// Returns the text of a - b, which names a switching function: "a-b", b in parentheses where it is a sum; "a+c" where
/// b is -c.
[[nodiscard]] std::string difference_text(const NodePtr& a, const NodePtr& b);

/// Returns names (not functions) that occur in the tree, each once, in order of appearance.
[[nodiscard]] std::vector<std::string> names_in(const Node& node);

struct FunctionSignature {
  std::string_view name;
  int arguments;
};

/// Returns all functions of the language.
[[nodiscard]] const std::vector<FunctionSignature>& functions();

/// Returns whether the language keeps `name` for itself: t, pi, and, or, not, otherwise and the names of functions.
[[nodiscard]] bool is_reserved(std::string_view name);

/// Returns whether `name` consists of letters, digits and underscores (ASCII) without a leading digit.
[[nodiscard]] bool is_identifier(std::string_view name);

}  // namespace saltus::expression
