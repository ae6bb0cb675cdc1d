// Which messages of runs that stopped early say the same.
#pragma once

#include <string>
#include <string_view>

namespace saltus::result {

/// Returns the message without its numbers and without the names in quotes: equal for runs that stopped for one reason.
[[nodiscard]] inline std::string cause_of(std::string_view message) {
  std::string cause;
  bool quoted = false;
  for (const char c : message) {
    if (c == '\'') quoted = !quoted;
    const bool number = (c >= '0' && c <= '9') || c == '.' || c == '-' || c == '+';
    if (!quoted && !number) cause += c;
  }
  return cause;
}

}  // namespace saltus::result
