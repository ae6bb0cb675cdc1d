// The messages of the parser: what was expected, what was found, what to write instead.
#pragma once

#include <string>
#include <vector>

#include "saltus/base/error.hpp"
#include "saltus/expression/lexer_internal.hpp"
#include "saltus/expression/syntax_tree.hpp"

namespace saltus::expression {

/// Makes errors about tokens of one expression; refers to its arguments and lives no longer than they do.
class Complaints {
 public:
  Complaints(const Tokens& tokens, const std::string& file) : tokens_(tokens), file_(file) {}

  [[nodiscard]] SourceLocation at(const Token& token) const { return {file_, token.line, token.column}; }

  [[nodiscard]] Error empty(const Token& end) const;

  /// An operand has to begin at the token with this index, and none does.
  [[nodiscard]] Error missing_operand(std::size_t index) const;

  /// After a complete operand, the token with this index neither goes on nor closes what is open.
  /// @param opening  the innermost open parenthesis, null outside of all
  [[nodiscard]] Error after_operand(std::size_t index, const Token* opening) const;

  [[nodiscard]] Error chained_comparison(const Token& token, const Node& left, const Node& right) const;
  [[nodiscard]] Error misplaced_not(const Token& token) const;
  [[nodiscard]] Error unknown_function(const Token& name, const std::vector<std::string>& extra_functions) const;
  [[nodiscard]] Error function_without_arguments(const Token& name) const;
  [[nodiscard]] Error wrong_arguments(const Token& name, int expected, int found) const;
  [[nodiscard]] Error too_nested(const Token& token) const;
  [[nodiscard]] Error too_high(const Token& token) const;

 private:
  Error failure(const Token& token, std::string message, std::string remedy) const;
  Error missing_operator(const Token& before, const Token& found) const;

  const Tokens& tokens_;
  const std::string& file_;
};

}  // namespace saltus::expression
