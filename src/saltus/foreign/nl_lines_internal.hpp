// The lines of an AMPL .nl text, and the first thing that is wrong with them.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "saltus/base/error.hpp"

namespace saltus::foreign {

/// Goes through a text line by line; what stands behind # is a comment, lines without words are skipped.
/// Keeps the first error: reading goes on with zeros, so that callers ask for it now and then (failed()).
class NlLines {
 public:
  NlLines(std::string_view text, std::string file);

  /// Goes to the next line with words; `expected` says what should stand there if there is none. False at the end.
  bool advance(std::string_view expected);
  /// Goes to the next line, if there is one.
  bool advance_if_any();

  [[nodiscard]] std::size_t words() const { return words_.size(); }
  [[nodiscard]] std::string_view word(std::size_t i) const { return i < words_.size() ? words_[i] : ""; }
  /// Returns the first character of the line: what segments and operands are called by.
  [[nodiscard]] char letter() const { return words_.empty() ? '\0' : words_.front().front(); }

  /// Reads word i as a whole number from low to high. `what` is what was expected, for the error.
  long whole(std::size_t i, std::string_view what, long low, long high);
  /// Reads what follows the letter of the line.
  long whole_behind_letter(std::string_view what, long low, long high);
  /// Reads word i as a number, infinite ones among them, NaN not.
  double number(std::size_t i, std::string_view what);
  double number_behind_letter(std::string_view what);

  void fail(std::string message, std::string remedy = "", ErrorCode code = ErrorCode::parse_failure);
  [[nodiscard]] bool failed() const { return error_.has_value(); }
  [[nodiscard]] const Error& error() const { return *error_; }
  [[nodiscard]] int line() const { return line_; }
  /// Returns the number of lines of the text from the next one on: no list in it is longer.
  [[nodiscard]] long lines_left() const { return lines_ - line_; }

 private:
  long whole_in(std::string_view text, std::string_view what, long low, long high);
  double number_in(std::string_view text, std::string_view what);

  std::string_view rest_;
  std::string file_;
  long lines_ = 0;
  int line_ = 0;
  std::vector<std::string_view> words_;
  std::optional<Error> error_;
};

}  // namespace saltus::foreign
