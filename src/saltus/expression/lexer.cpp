#include <algorithm>
#include <array>
#include <charconv>
#include <string>
#include <system_error>

#include <fmt/format.h>

#include "saltus/expression/lexer_internal.hpp"
#include "saltus/expression/mistakes_internal.hpp"

namespace saltus::expression {
namespace {

// Not <cctype>: its functions depend on the locale.
bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }
bool is_name_character(char c) { return is_letter(c) || is_digit(c) || c == '_'; }
bool is_space(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

// Longer ones first: the first match is taken.
constexpr std::array<std::string_view, 14> symbols{"<=", ">=", "==", "!=", "<", ">", "+",
                                                   "-",  "*",  "/",  "^",  "(", ")", ","};

/// Extent of a number, and what is wrong with it if anything is.
struct NumberScan {
  std::size_t size = 0;
  std::string message, remedy;
};

class Lexer {
 public:
  Lexer(std::string_view text, const SourceLocation& start)
      : text_(text), file_(start.file), line_(std::max(start.line, 1)), column_(std::max(start.column, 1)) {
    // The end of the expression is where its last character is, not where the closing quote may be lines below.
    while (!text_.empty() && is_space(text_.back())) text_.remove_suffix(1);
  }

  Tokens run() {
    for (skip_space(); position_ < text_.size(); skip_space()) {
      read_token();
      if (tokens_.invalid) return std::move(tokens_);
    }
    add(TokenKind::end, 0);
    return std::move(tokens_);
  }

 private:
  std::string_view rest() const { return text_.substr(position_); }
  char at(std::size_t offset) const { return position_ + offset < text_.size() ? text_[position_ + offset] : '\0'; }

  std::size_t run_length(std::size_t offset, bool (*belongs)(char)) const {
    const std::size_t first = offset;
    while (position_ + offset < text_.size() && belongs(at(offset))) ++offset;
    return offset - first;
  }

  void skip_space() {
    for (; position_ < text_.size() && is_space(text_[position_]); ++position_) {
      if (text_[position_] == '\n') {
        ++line_;
        column_ = 1;
      } else {
        ++column_;
      }
    }
  }

  Token& add(TokenKind kind, std::size_t size) {
    tokens_.list.push_back({kind, text_.substr(position_, size), 0.0, line_, column_});
    position_ += size;
    column_ += static_cast<int>(size);
    return tokens_.list.back();
  }

  void refuse(std::size_t size, std::string message, std::string_view remedy) {
    const Token& token = add(TokenKind::invalid, size);
    tokens_.invalid = Error{ErrorCode::parse_failure,
                            std::move(message),
                            std::string(remedy),
                            {std::string(file_), token.line, token.column},
                            {}};
  }

  void read_token() {
    const char first = at(0);
    if (is_digit(first) || (first == '.' && is_digit(at(1)))) {
      read_number();
    } else if (is_letter(first) || first == '_') {
      add(TokenKind::name, run_length(0, is_name_character));
    } else {
      read_symbol();
    }
  }

  void read_symbol() {
    if (const auto* mistake = long_symbol_mistake(rest())) {
      return refuse(mistake->text.size(), fmt::format("unknown operator {}", quoted(mistake->text)), mistake->remedy);
    }
    for (const auto symbol : symbols) {
      if (rest().starts_with(symbol)) return static_cast<void>(add(TokenKind::symbol, symbol.size()));
    }
    if (at(0) == '=' && follows_half_comparison()) {
      const auto half = tokens_.list.back().text;
      return refuse(1, fmt::format("'=' stands apart from '{}'", half),
                    fmt::format("write '{}=' without a space", half));
    }
    if (const auto* mistake = short_symbol_mistake(rest())) {
      return refuse(1, fmt::format("unexpected {}", quoted(mistake->text)), mistake->remedy);
    }
    const auto foreign = foreign_character(rest());
    refuse(foreign.text.size(), fmt::format("unexpected {}", foreign.description), foreign.remedy);
  }

  bool follows_half_comparison() const {
    if (tokens_.list.empty()) return false;
    const Token& last = tokens_.list.back();
    return last.is(TokenKind::symbol, "<") || last.is(TokenKind::symbol, ">");
  }

  /// digits [. digits] [e [sign] digits], with at least one digit before the exponent.
  NumberScan scan_number() const {
    if (at(0) == '0' && (at(1) == 'x' || at(1) == 'X' || at(1) == 'b' || at(1) == 'o') && is_digit(at(2))) {
      return {0, "not a decimal number", "numbers are decimal: write 16, not 0x10"};
    }
    std::size_t size = run_length(0, is_digit);
    if (at(size) == '.') size += 1 + run_length(size + 1, is_digit);
    if (at(size) == 'e' || at(size) == 'E') {
      const std::size_t sign = at(size + 1) == '+' || at(size + 1) == '-' ? 1 : 0;
      const std::size_t digits = run_length(size + 1 + sign, is_digit);
      if (digits > 0) {
        size += 1 + sign + digits;
      } else if (sign > 0 || !is_name_character(at(size + 1))) {  // else 2exp(x): a missing operator
        return {size + 1 + sign, "the exponent has no digits",
                "write 1e3 for a power of ten, exp(1) for Euler's number"};
      }
    }
    if (at(size) == '.')
      return {size, "one decimal point too many", "a number has one decimal point, an exponent has none"};
    if (at(size) == '_' && is_digit(at(size + 1))) return {size, "digits are not grouped", "write it without '_'"};
    return {size, "", ""};
  }

  void read_number() {
    NumberScan scan = scan_number();
    double value = 0.0;
    if (scan.message.empty()) {
      const char* first = text_.data() + position_;
      if (std::from_chars(first, first + scan.size, value).ec != std::errc{}) {
        scan.message = "beyond the range of double precision (about 5e-324 to 1.8e308)";
        scan.remedy = "choose other units";
      }
    }
    if (scan.message.empty()) {
      add(TokenKind::number, scan.size).value = value;
      return;
    }
    const auto shown = scan.size + run_length(scan.size, [](char c) { return is_name_character(c) || c == '.'; });
    refuse(shown, fmt::format("malformed number {}: {}", quoted(rest().substr(0, shown)), scan.message), scan.remedy);
  }

  std::string_view text_;
  std::string_view file_;
  std::size_t position_ = 0;
  int line_, column_;
  Tokens tokens_;
};

}  // namespace

Tokens tokenize(std::string_view text, const SourceLocation& start) { return Lexer(text, start).run(); }

}  // namespace saltus::expression
