// What a person meant who wrote a line that is no TOML.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace saltus::io {

struct Slip {
  std::string message;
  std::string remedy;
};

/// Returns whether a key stands in TOML without quotes.
[[nodiscard]] bool is_plain_name(std::string_view key);

/// Returns what is wrong with a line, and what to write instead.
/// @param column       where its reader stopped, in characters from 1
/// @param description  what it said
[[nodiscard]] Slip slip_in(std::string_view line, std::size_t column, std::string_view description);

}  // namespace saltus::io
