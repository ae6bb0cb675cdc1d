#include <algorithm>
#include <array>
#include <utility>

#include <fmt/format.h>

#include "saltus/base/contains.hpp"
#include "saltus/expression/complaints_internal.hpp"
#include "saltus/expression/grammar_internal.hpp"
#include "saltus/expression/limits_internal.hpp"
#include "saltus/expression/mistakes_internal.hpp"
#include "saltus/expression/parser.hpp"

namespace saltus::expression {
namespace {

std::string shown(const Token& token) {
  return token.kind == TokenKind::end ? "the end of the expression" : quoted(token.text);
}

bool begins_operand(const Token& token) {
  return token.kind == TokenKind::number || token.kind == TokenKind::name || token.is(TokenKind::symbol, "(");
}

bool is_word_of_other_conditionals(const Token& token) {
  constexpr std::array<std::string_view, 4> words{"if", "then", "else", "elseif"};
  return token.kind == TokenKind::name && contains(words, token.text);
}

/// How a call of the function is written.
std::string usage(std::string_view function, int arguments) {
  if (function == "if") return "if(condition, a, b)";
  if (function == "atan2") return "atan2(y, x)";
  return fmt::format("{}({})", function, arguments == 1 ? "x" : "a, b");
}

std::string remedy_for_arguments(std::string_view function, int expected, int found) {
  if ((function == "max" || function == "min") && found > expected) {
    return fmt::format("nest them: {0}(a, {0}(b, c))", function);
  }
  if (function == "log" && found == 2) return "log is the natural logarithm; to another base write log(x)/log(base)";
  if (function == "atan" && found == 2) return "write atan2(y, x)";
  return fmt::format("write {}", usage(function, expected));
}

std::string function_list(const std::vector<std::string>& extra_functions) {
  std::string list;
  for (const auto& function : functions()) list += fmt::format("{}{}", list.empty() ? "" : " ", function.name);
  for (const auto& name : extra_functions) list += " " + name;
  return list;
}

/// x(t), as it stands in textbooks: a state or control with its time.
bool has_time_as_argument(const Tokens& tokens, std::size_t index) {
  return index + 3 < tokens.list.size() && tokens.list[index + 2].is(TokenKind::name, "t") &&
         tokens.list[index + 3].is(TokenKind::symbol, ")");
}

/// Names of the model come before those of other languages.
std::string remedy_for_unknown_function(const Tokens& tokens, std::size_t index,
                                        const std::vector<std::string>& extra_functions,
                                        const std::vector<std::string>& declared) {
  const std::string name(tokens.list[index].text);
  if (!contains(declared, name)) {
    if (!nearest_names(name, extra_functions).empty()) return suggest(name, extra_functions);
    if (const auto remedy = remedy_for_function(name); !remedy.empty()) return std::string(remedy);
    std::vector<std::string> known;
    for (const auto& function : functions()) known.emplace_back(function.name);
    if (!nearest_names(name, known).empty()) return suggest(name, known);
  }
  const auto shown_name = name.substr(0, 40);
  if (has_time_as_argument(tokens, index)) return fmt::format("names stand without their time: write {}", shown_name);
  return fmt::format("for a product write {}*(…); the functions are: {}", shown_name, function_list(extra_functions));
}

/// Where the operator goes; a product is what is meant most often.
std::string product_of(const Token& before, const Token& found) {
  if (before.kind == TokenKind::symbol || before.text.size() + found.text.size() > 40) return "'*' between them";
  return fmt::format("{}*{}", before.text, found.kind == TokenKind::symbol ? "(…)" : found.text);
}

}  // namespace

std::nullopt_t Complaints::failure(const Token& token, std::string message, std::string remedy) {
  error_ = {ErrorCode::parse_failure, std::move(message), std::move(remedy), at(token), {}};
  return std::nullopt;
}

std::nullopt_t Complaints::invalid_token() {
  error_ = *tokens_.invalid;
  return std::nullopt;
}

std::nullopt_t Complaints::empty(const Token& end) {
  return failure(end, "empty expression", "write a number or a formula, for example 0");
}

std::nullopt_t Complaints::missing_operand(std::size_t index) {
  const Token& found = tokens_.list[index];
  if (found.kind == TokenKind::invalid) return invalid_token();
  if (index == 0) {
    return failure(found, fmt::format("expected a number, a name or '(', found {}", shown(found)),
                   "begin with an operand; only '+', '-' and 'not' stand before one");
  }
  const Token& before = tokens_.list[index - 1];
  if (before.is(TokenKind::symbol, "(") && found.is(TokenKind::symbol, ")")) {
    return failure(found, "nothing between the parentheses", "write an expression between them or delete them");
  }
  const auto* remedy = found.kind == TokenKind::end ? "write the operand that is missing or delete the rest"
                                                    : "write the operand that is missing between the two";
  return failure(found, fmt::format("expected a number, a name or '(' after {}, found {}", shown(before), shown(found)),
                 remedy);
}

std::nullopt_t Complaints::after_operand(std::size_t index, const Token* opening) {
  const Token& found = tokens_.list[index];
  if (found.kind == TokenKind::invalid) return invalid_token();
  if (begins_operand(found)) return missing_operator(tokens_.list[index - 1], found);
  if (opening != nullptr && found.kind == TokenKind::end) {
    return failure(found, fmt::format("missing ')' for the '(' at line {}, column {}", opening->line, opening->column),
                   "close the parenthesis");
  }
  if (found.is(TokenKind::symbol, ")")) {
    return failure(found, "')' without a '(' before it", "delete it or write the '(' that is missing");
  }
  return failure(found, fmt::format("unexpected {}", shown(found)),
                 "decimal numbers are written with a point, as in 1.5; ',' separates the arguments of a function");
}

std::nullopt_t Complaints::missing_operator(const Token& before, const Token& found) {
  auto message = fmt::format("missing operator between {} and {}", shown(before), shown(found));
  if (is_word_of_other_conditionals(before) || is_word_of_other_conditionals(found)) {
    return failure(found, std::move(message), "write if(condition, a, b)");
  }
  if (found.is(TokenKind::name, "not")) return failure(found, std::move(message), "write 'and not' or 'or not'");
  for (const auto* word : {"and", "or", "not"}) {
    for (const auto& token : {before, found}) {
      const bool same = token.text.size() == std::string_view(word).size() &&
                        std::equal(token.text.begin(), token.text.end(), word,
                                   [](char a, char b) { return a == b || a == b - 'a' + 'A'; });
      if (same) return failure(found, std::move(message), fmt::format("write '{}' in lower case", word));
    }
  }
  const bool like_unit = before.kind == TokenKind::number && found.kind == TokenKind::name;
  return failure(found, std::move(message),
                 fmt::format("for a product write {}{}", product_of(before, found),
                             like_unit ? "; units are no part of expressions" : ""));
}

std::nullopt_t Complaints::chained_comparison(const Token& token, const Node& left, const Node& right) {
  const auto& first = std::get<Binary>(left.value);
  auto pair = fmt::format("{} and {}{}{}", to_text(left), to_text(*first.right), token.text, to_text(right));
  if (pair.size() > 80) pair = "a<b and b<c";
  return failure(token, "comparisons do not chain", fmt::format("write '{}'", pair));
}

std::nullopt_t Complaints::misplaced_not(const Token& token) {
  return failure(token, "'not' binds looser than what stands before it", "put it in parentheses: (not …)");
}

std::nullopt_t Complaints::unknown_function(std::size_t index, const std::vector<std::string>& extra_functions,
                                            const std::vector<std::string>& declared) {
  const Token& name = tokens_.list[index];
  failure(name, fmt::format("unknown function {}", quoted(name.text)),
          remedy_for_unknown_function(tokens_, index, extra_functions, declared));
  error_.code = ErrorCode::unknown_name;
  return std::nullopt;
}

std::nullopt_t Complaints::function_without_arguments(const Token& name) {
  int arguments = 1;
  for (const auto& function : functions()) {
    if (function.name == name.text) arguments = function.arguments;
  }
  return failure(name, fmt::format("the function {} stands without its arguments", quoted(name.text)),
                 fmt::format("write {}", usage(name.text, arguments)));
}

std::nullopt_t Complaints::wrong_arguments(const Token& name, int expected, int found) {
  return failure(
      name,
      fmt::format("{} takes {} argument{}, found {}", quoted(name.text), expected, expected == 1 ? "" : "s", found),
      remedy_for_arguments(name.text, expected, found));
}

std::nullopt_t Complaints::too_nested(const Token& token) {
  return failure(token, fmt::format("nested deeper than {} levels", max_nesting), "name parts of it in [definitions]");
}

std::nullopt_t Complaints::too_high(const Token& token) {
  return failure(token, fmt::format("a chain of more than {} operands", max_height),
                 "group its terms in parentheses or name parts of it in [definitions]");
}

}  // namespace saltus::expression
