// What went wrong with the input, where it stands, and what to do about it.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <tl/expected.hpp>

namespace saltus {

/// Holds a place in a text file; line and column count from 1, 0 means unknown.
struct SourceLocation {
  std::string file;
  int line = 0;
  int column = 0;
};

enum class ErrorCode {
  parse_failure,   ///< the text is not well formed
  unknown_name,    ///< a name, table or key nobody declared
  invalid_model,   ///< well formed, but states no system
  invalid_option,  ///< an option outside its range
  not_available,   ///< stated correctly, but this version does not do it
  io_failure,      ///< a file that cannot be read or written
};

/// Holds bad input (lane 2 of the three error lanes): reported to the user, mapped to exit code 2.
struct Error {
  ErrorCode code = ErrorCode::invalid_model;
  std::string message;               ///< what was expected and what was found
  std::string remedy;                ///< what the user can do; may be empty
  SourceLocation location;           ///< where; empty file = command line or C++
  std::vector<std::string> context;  ///< innermost first
};

template <class T>
using Expected = tl::expected<T, Error>;

/// Adds one frame ("in table [simulate]") to the trail of an error.
[[nodiscard]] inline Error with_context(Error error, std::string frame) {
  if (error.context.empty() || error.context.back() != frame) error.context.push_back(std::move(frame));
  return error;
}

/// Returns "file:line:column: error: message", trail and remedy, a line each; control characters as \xNN, parts <= 2000
/// bytes.
[[nodiscard]] std::string to_text(const Error& error);

/// Returns the known names nearest to `name` by edit distance, best first, at most three; for "did you mean" remedies.
/// Where none is near, those that begin with it, or with which it begins. For names that a user gives; of words of
/// ours see other_words.hpp.
[[nodiscard]] std::vector<std::string> nearest_names(const std::string& name, const std::vector<std::string>& known);

/// Returns "did you mean 'a' or 'b'?" or, if nothing is near, "known: a, b, c"; empty if nothing is known.
[[nodiscard]] std::string suggest(const std::string& name, const std::vector<std::string>& known);
/// Returns the same of names that are near.
[[nodiscard]] std::string suggestion(const std::vector<std::string>& nearest, const std::vector<std::string>& known);

}  // namespace saltus
