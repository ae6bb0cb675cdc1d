// Text of an expression -> syntax tree with source positions.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "saltus/base/error.hpp"
#include "saltus/expression/syntax_tree.hpp"

namespace saltus::expression {

/// Parses one expression.
/// Precedence, loosest first: or, and, not, comparisons (non-associative), + -, * /, unary minus, ^ (right associative).
/// Checks names of functions and their number of arguments; does not know which names exist otherwise.
/// @param text   the expression
/// @param start  position of its first character in its file; offsets within a line add to the column
/// @return the tree, or a parse_failure / unknown_name with position, what was expected and a remedy.
///         Nesting deeper than 200 levels and texts beyond 64 KiB are refused.
[[nodiscard]] Expected<NodePtr> parse(std::string_view text, const SourceLocation& start);

/// A number as a tree, e.g. for a bare number in a model file.
[[nodiscard]] NodePtr number(double value, const SourceLocation& location);

/// The text of a tree without spaces, with the parentheses that were written (used to name switching functions).
[[nodiscard]] std::string to_text(const Node& node);

/// Names (not functions) that occur in the tree, each once, in order of appearance.
[[nodiscard]] std::vector<std::string> names_in(const Node& node);

/// All functions of the language: name and number of arguments. `t`, `pi` and these names are reserved.
struct FunctionSignature { std::string_view name; int arguments; };
[[nodiscard]] const std::vector<FunctionSignature>& functions();

/// Whether `name` may be declared by a user: letters, digits, underscore, no leading digit, not reserved
/// (t, pi, and, or, not, function names, otherwise).
[[nodiscard]] bool is_reserved(std::string_view name);
[[nodiscard]] bool is_identifier(std::string_view name);

}  // namespace saltus::expression
