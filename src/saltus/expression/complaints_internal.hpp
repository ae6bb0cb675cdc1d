// The messages of the parser: what was expected, what was found, what to write instead.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "saltus/base/error.hpp"
#include "saltus/expression/lexer_internal.hpp"
#include "saltus/expression/syntax_tree.hpp"

namespace saltus::expression {

/// Keeps the error about one expression; refers to its arguments and lives no longer than they do.
/// Every complaint is the result of a parser function that failed: nothing.
class Complaints {
 public:
  Complaints(const Tokens& tokens, const std::string& file) : tokens_(tokens), file_(file) {}

  [[nodiscard]] SourceLocation at(const Token& token) const { return {file_, token.line, token.column}; }

  /// Returns the error; there has been a complaint.
  [[nodiscard]] Error take() { return std::move(error_); }

  std::nullopt_t empty(const Token& end);

  /// Notes that an operand has to begin at the token with this index, and none does.
  std::nullopt_t missing_operand(std::size_t index);

  /// Notes that, after a complete operand, the token with this index neither goes on nor closes what is open.
  /// @param opening  the innermost open parenthesis, null outside of all
  std::nullopt_t after_operand(std::size_t index, const Token* opening);

  std::nullopt_t chained_comparison(const Token& token, const Node& left, const Node& right);
  std::nullopt_t misplaced_not(const Token& token);
  std::nullopt_t unknown_function(std::size_t index, const std::vector<std::string>& extra_functions,
                                  const std::vector<std::string>& declared);
  std::nullopt_t function_without_arguments(const Token& name);
  std::nullopt_t wrong_arguments(const Token& name, int expected, int found);
  std::nullopt_t too_nested(const Token& token);
  std::nullopt_t too_high(const Token& token);

 private:
  std::nullopt_t failure(const Token& token, std::string message, std::string remedy);
  std::nullopt_t invalid_token();
  std::nullopt_t missing_operator(const Token& before, const Token& found);

  const Tokens& tokens_;
  const std::string& file_;
  Error error_;
};

}  // namespace saltus::expression
