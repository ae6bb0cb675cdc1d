// What people write out of habit from other languages, and what to write instead.
#pragma once

#include <string>
#include <string_view>

namespace saltus::expression {

/// Returns a text in single quotes for a message, shortened if it is long.
[[nodiscard]] std::string quoted(std::string_view text);

struct SymbolMistake {
  std::string_view text;
  std::string_view remedy;
};

/// Returns the longest operator of another language with two or more characters ("**", "&&") at the beginning of
/// `rest`, or null.
[[nodiscard]] const SymbolMistake* long_symbol_mistake(std::string_view rest);

/// Does likewise for a single character that no expression contains ("%", "["), or null.
[[nodiscard]] const SymbolMistake* short_symbol_mistake(std::string_view rest);

/// Holds one character beyond printable ASCII at the beginning of a text.
struct ForeignCharacter {
  std::string_view text;    ///< its bytes
  std::string description;  ///< "'−' (U+2212, minus sign)"; or the byte if it is no UTF-8
  std::string remedy;
};
[[nodiscard]] ForeignCharacter foreign_character(std::string_view rest);

/// Returns what to write instead of the function `name` of another language ("ln", "arcsin"); empty if it is none we
/// know.
[[nodiscard]] std::string_view remedy_for_function(std::string_view name);

}  // namespace saltus::expression
