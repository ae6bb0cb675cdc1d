#include <algorithm>
#include <array>
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

/// What is known by its first bytes, after "this is"; empty if nothing is.
std::string_view binary_format(std::string_view text, std::string_view file) {
  struct Format {
    std::string_view begins, what;
  };
  if (text.starts_with("PK\x03\x04") && file.ends_with(".xlsx")) return "a workbook of Excel";
  for (const auto& [begins, what] :
       std::array{Format{"PK\x03\x04", "a zip archive, as .xlsx and .npz files are"},
                  Format{"MATLAB 5.0 MAT-file", "a MAT-file"}, Format{"MATLAB 7.3 MAT-file", "a MAT-file"},
                  Format{"\x89HDF", "an HDF5 file"}, Format{"\x93NUMPY", "an array of NumPy"},
                  Format{"PAR1", "a Parquet file"}, Format{"\xD0\xCF\x11\xE0", "an old file of Excel or Word"}}) {
    if (text.starts_with(begins)) return what;
  }
  return {};
}

}  // namespace

Expected<void> check_is_text(std::string_view text, const std::string& file, std::string_view remedy) {
  const SourceLocation whole{file, 0, 0};
  if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF")) {
    return tl::unexpected(not_readable(whole, "the file is UTF-16", "save it as UTF-8"));
  }
  if (const auto known = binary_format(text, file); !known.empty()) {
    return tl::unexpected(not_readable(whole, fmt::format("this is {}", known), std::string(remedy)));
  }
  if (const auto place = text.find('\0'); place != std::string_view::npos) {
    return tl::unexpected(
        not_readable(whole, fmt::format("this is no text file: byte {} is 0", place), std::string(remedy)));
  }
  return {};
}

Expected<void> check_encoding(std::string_view text, const std::string& file) {
  const SourceLocation whole{file, 0, 0};
  const bool blank = std::all_of(text.begin(), text.end(), [](unsigned char c) { return std::isspace(c) != 0; });
  if (blank) {
    return tl::unexpected(not_readable(whole, "the file is empty",
                                       "a model needs at least [model] with a name, [states] and [dynamics]"));
  }
  if (auto is_text = check_is_text(text, file, "a model file is TOML: text in UTF-8"); !is_text) return is_text;
  return check_characters(text, file);
}

}  // namespace saltus::io
