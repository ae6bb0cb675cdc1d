#include <algorithm>
#include <cctype>
#include <cstddef>
#include <utility>

#include <fmt/format.h>

#include "saltus/io/text_encoding_internal.hpp"

namespace saltus::io {
namespace {

Error not_readable(SourceLocation location, std::string message, std::string remedy) {
  return {ErrorCode::parse_failure, std::move(message), std::move(remedy), std::move(location), {}};
}

unsigned char byte(std::string_view text, std::size_t place) { return static_cast<unsigned char>(text[place]); }

/// Bytes of the character that begins at a place; 0 if none does. Overlong forms and surrogates are left to toml++.
std::size_t character_size(std::string_view text, std::size_t place) {
  const unsigned char first = byte(text, place);
  if (first < 0x80U) return 1;
  const std::size_t size = first >= 0xF0U ? 4 : (first >= 0xE0U ? 3 : 2);
  if (first < 0xC2U || first > 0xF4U || place + size > text.size()) return 0;
  for (std::size_t i = 1; i < size; ++i) {
    if ((byte(text, place + i) & 0xC0U) != 0x80U) return 0;
  }
  return size;
}

/// The first byte that belongs to no character, with its line and column.
Expected<void> check_characters(std::string_view text, const std::string& file) {
  SourceLocation location{file, 1, 1};
  for (std::size_t place = 0; place < text.size();) {
    const auto size = character_size(text, place);
    if (size == 0) {
      return tl::unexpected(not_readable(location,
                                         fmt::format("not valid UTF-8: byte {} is 0x{:02X}", place, byte(text, place)),
                                         "save it as UTF-8; it looks like Latin-1 or another encoding"));
    }
    if (text[place] == '\n') {
      ++location.line;
      location.column = 1;
    } else {
      ++location.column;
    }
    place += size;
  }
  return {};
}

}  // namespace

Expected<void> check_encoding(std::string_view text, const std::string& file) {
  const SourceLocation whole{file, 0, 0};
  const bool blank = std::all_of(text.begin(), text.end(), [](unsigned char c) { return std::isspace(c) != 0; });
  if (blank) {
    return tl::unexpected(not_readable(whole, "the file is empty",
                                       "a model needs at least [model] with a name, [states] and [dynamics]"));
  }
  if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF")) {
    return tl::unexpected(not_readable(whole, "the file is UTF-16", "save it as UTF-8"));
  }
  if (const auto place = text.find('\0'); place != std::string_view::npos) {
    return tl::unexpected(not_readable(whole, fmt::format("this is no text file: byte {} is 0", place),
                                       "a model file is TOML: text in UTF-8"));
  }
  return check_characters(text, file);
}

}  // namespace saltus::io
