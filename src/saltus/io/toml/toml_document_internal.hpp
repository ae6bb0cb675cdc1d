// A TOML text as plain values with positions, in the order of the file. Only the source behind it knows toml++.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "saltus/base/error.hpp"
#include "saltus/io/toml/string_places_internal.hpp"

namespace saltus::io {

struct TomlEntry;
struct TomlValue;
using TomlTable = std::vector<TomlEntry>;
using TomlArray = std::vector<TomlValue>;

/// Holds `start`, the place of the first character of the content, behind the quotes.
struct TomlString {
  std::string text;
  SourceLocation start;
  std::vector<StringAnchor> anchors;  ///< empty: the text stands as it is from `start` on
};
struct TomlDate {};

struct TomlValue {
  std::variant<bool, std::int64_t, double, TomlString, TomlDate, TomlArray, TomlTable> value;
  SourceLocation location;
};

struct TomlEntry {
  std::string key;
  SourceLocation location;  ///< of the key
  TomlValue value;
};

/// Parses a document. Tables are in the order of their keys in the file.
/// A byte order mark of UTF-8 in front of it counts as nothing.
/// @return the root, or a parse_failure with position. A text that is empty or no text at all (NUL bytes, UTF-16) is
///         refused with a message of its own.
[[nodiscard]] Expected<TomlTable> parse_toml(std::string_view text, const std::string& file);

/// Returns "the number 3", "a string", "a table": what was found in the place of what was expected.
[[nodiscard]] std::string description_of(const TomlValue& value);

}  // namespace saltus::io
