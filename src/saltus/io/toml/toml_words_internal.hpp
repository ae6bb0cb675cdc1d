// Words out of a closed set in a model file: direction = "up", inclusion = "filippov".
#pragma once

#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>

#include "saltus/base/other_words.hpp"
#include "saltus/io/toml/toml_reader_internal.hpp"

namespace saltus::io {

template <class Enum>
std::vector<std::string> names_of(const std::vector<std::pair<std::string, Enum>>& choices) {
  std::vector<std::string> names;
  for (const auto& [name, value] : choices) names.push_back(name);
  return names;
}

/// Returns the value that a word names, or an error without location.
template <class Enum>
Expected<Enum> enum_named(const std::string& word, const std::vector<std::pair<std::string, Enum>>& choices) {
  for (const auto& [name, value] : choices) {
    if (name == word) return value;
  }
  const auto known = names_of(choices);
  return tl::unexpected(
      Error{ErrorCode::invalid_option,
            fmt::format("expected \"{}\", found the string \"{}\"", fmt::join(known, "\" or \""), word),
            nearest_words(word, known).empty() ? "" : suggest_word(word, known),
            {},
            {}});
}

/// Reads a word out of a closed set; `fallback` after an error.
template <class Enum>
Enum read_enum(TomlReader& reader, const TomlValue& value, const std::vector<std::pair<std::string, Enum>>& choices,
               Enum fallback) {
  const auto* word = std::get_if<TomlString>(&value.value);
  if (word == nullptr) {
    reader.wrong_type(fmt::format("\"{}\"", fmt::join(names_of(choices), "\" or \"")), value);
    return fallback;
  }
  auto found = enum_named(word->text, choices);
  if (found) return *found;
  found.error().location = value.location;
  reader.fail(found.error());
  return fallback;
}

}  // namespace saltus::io
