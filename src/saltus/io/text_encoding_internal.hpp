// Files that are no text, or not the text they look like.
#pragma once

#include <string>
#include <string_view>

#include "saltus/base/error.hpp"

namespace saltus::io {

/// Refuses what is not UTF-8 text: nothing but blanks, UTF-16, NUL bytes, bytes that no character begins or goes on
/// with.
/// @return nothing, or a parse_failure that says how to save the file
[[nodiscard]] Expected<void> check_encoding(std::string_view text, const std::string& file);

}  // namespace saltus::io
