// Trees in tests: comparison up to positions, and a text that shows every level.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>
#include <variant>

#include <fmt/format.h>

#include "saltus/expression/parser.hpp"
#include "saltus/expression/syntax_tree.hpp"

namespace saltus::expression {

enum class Parentheses { compared, ignored };

[[nodiscard]] inline bool same_tree(const Node& a, const Node& b, Parentheses parentheses = Parentheses::compared) {
  if (parentheses == Parentheses::compared && a.parenthesised != b.parenthesised) return false;
  if (a.value.index() != b.value.index()) return false;
  if (const auto* number = std::get_if<Number>(&a.value)) return number->value == std::get<Number>(b.value).value;
  if (const auto* name = std::get_if<Name>(&a.value)) return name->name == std::get<Name>(b.value).name;
  if (const auto* unary = std::get_if<Unary>(&a.value)) {
    const auto& other = std::get<Unary>(b.value);
    return unary->op == other.op && same_tree(*unary->operand, *other.operand, parentheses);
  }
  if (const auto* binary = std::get_if<Binary>(&a.value)) {
    const auto& other = std::get<Binary>(b.value);
    return binary->op == other.op && same_tree(*binary->left, *other.left, parentheses) &&
           same_tree(*binary->right, *other.right, parentheses);
  }
  const auto& call = std::get<Call>(a.value);
  const auto& other = std::get<Call>(b.value);
  if (call.function != other.function || call.arguments.size() != other.arguments.size()) return false;
  for (std::size_t i = 0; i < call.arguments.size(); ++i) {
    if (!same_tree(*call.arguments[i], *other.arguments[i], parentheses)) return false;
  }
  return true;
}

/// The tree as nested lists: -2^2 is (minus (power 2 2)). Independent of to_text and of written parentheses.
[[nodiscard]] inline std::string shape(const Node& node) {
  constexpr const char* unary_names[] = {"minus", "plus", "not"};
  constexpr const char* binary_names[] = {"add",       "subtract",   "multiply", "divide",        "power",
                                          "less",      "less_equal", "greater",  "greater_equal", "equal",
                                          "not_equal", "and",        "or"};
  if (const auto* number = std::get_if<Number>(&node.value)) return fmt::format("{}", number->value);
  if (const auto* name = std::get_if<Name>(&node.value)) return name->name;
  if (const auto* unary = std::get_if<Unary>(&node.value)) {
    return fmt::format("({} {})", unary_names[static_cast<std::size_t>(unary->op)], shape(*unary->operand));
  }
  if (const auto* binary = std::get_if<Binary>(&node.value)) {
    return fmt::format("({} {} {})", binary_names[static_cast<std::size_t>(binary->op)], shape(*binary->left),
                       shape(*binary->right));
  }
  const auto& call = std::get<Call>(node.value);
  std::string text = "(" + call.function;
  for (const auto& argument : call.arguments) text += " " + shape(*argument);
  return text + ")";
}

/// Whether a position lies in a text that starts at line 1, column 1, or just behind one of its lines.
[[nodiscard]] inline bool is_inside(const SourceLocation& location, std::string_view text) {
  int line = 1;
  for (; line < location.line; ++line) {
    const auto end = text.find('\n');
    if (end == std::string_view::npos) return false;
    text.remove_prefix(end + 1);
  }
  const auto length = std::min(text.find('\n'), text.size());
  return location.line == line && location.column >= 1 && static_cast<std::size_t>(location.column) <= length + 1;
}

/// What holds for every text: a tree that to_text reproduces, or an error that says what and where.
/// @return empty if it holds, else what does not
[[nodiscard]] inline std::string broken_promise(std::string_view text) {
  const auto tree = parse(text, {"", 1, 1}, {"road"});
  if (!tree) {
    const Error& error = tree.error();
    if (error.message.empty() || error.remedy.empty()) return "an error without message or remedy";
    if (!is_inside(error.location, text)) return fmt::format("the error lies outside: {}", error.location.column);
    return "";
  }
  if (!is_inside((*tree)->location, text)) return "the tree lies outside";
  const std::string written = to_text(**tree);
  const auto again = parse(written, {"", 1, 1}, {"road"});
  if (!again) return fmt::format("'{}' does not parse: {}", written, again.error().message);
  if (!same_tree(**tree, **again)) return fmt::format("'{}' is another tree", written);
  return names_in(**tree) == names_in(**again) ? "" : "other names";
}

}  // namespace saltus::expression
