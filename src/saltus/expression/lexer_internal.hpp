// Text of an expression -> tokens with positions.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "saltus/base/error.hpp"

namespace saltus::expression {

enum class TokenKind { number, name, symbol, end, invalid };

/// Holds a `text`, which views the expression: a token lives no longer than the text it was cut from.
struct Token {
  TokenKind kind = TokenKind::end;
  std::string_view text;
  double value = 0.0;  ///< of a number
  int line = 0;
  int column = 0;

  [[nodiscard]] bool is(TokenKind some_kind, std::string_view some_text) const {
    return kind == some_kind && text == some_text;
  }
};

/// Holds at least one token; the last one is the end, or invalid if the rest cannot be cut into tokens.
struct Tokens {
  std::vector<Token> list;
  std::optional<Error> invalid;  ///< what is wrong with the invalid token, if there is one
};

/// Cuts the text into tokens. Stops at the first place that cannot be one and leaves the report to the parser, so that
/// an error further left is told first.
/// @param start  position of the first character; unknown line or column (0) counts as 1
[[nodiscard]] Tokens tokenize(std::string_view text, const SourceLocation& start);

}  // namespace saltus::expression
