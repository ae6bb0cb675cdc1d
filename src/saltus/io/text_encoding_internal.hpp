// Files that are no text, or not the text they look like.
#pragma once

#include <string>
#include <string_view>

#include "saltus/base/error.hpp"

namespace saltus::io {

/// What to do with numbers in a file that is no text.
inline constexpr std::string_view data_remedy = "save the numbers as text: columns between commas (CSV), in UTF-8";

/// Refuses UTF-16, formats that are known by their first bytes, and NUL bytes.
/// @param file  its name, for the place and for what its ending says
[[nodiscard]] Expected<void> check_is_text(std::string_view text, const std::string& file, std::string_view remedy);

/// Refuses what is not UTF-8 text: nothing but blanks, what check_is_text refuses, bytes that no character begins or
/// goes on with.
/// @return nothing, or a parse_failure that says how to save the file
[[nodiscard]] Expected<void> check_encoding(std::string_view text, const std::string& file);

}  // namespace saltus::io
