#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "saltus/base/other_words.hpp"
#include "saltus/base/same_place.hpp"
#include "saltus/expression/parser.hpp"
#include "saltus/io/toml/toml_reader_internal.hpp"

namespace saltus::io {
namespace {

constexpr std::string_view number_or_expression = "a number or an expression in quotes";

std::optional<double> number_in(const TomlValue& value) {
  if (const auto* real = std::get_if<double>(&value.value)) return *real;
  if (const auto* integer = std::get_if<std::int64_t>(&value.value)) return static_cast<double>(*integer);
  return std::nullopt;
}

/// Line and column of a byte, counted from the beginning of the string's value.
SourceLocation place_within(const TomlString& text, std::size_t offset) {
  const auto before = std::string_view(text.text).substr(0, offset);
  const auto breaks = std::count(before.begin(), before.end(), '\n');
  const auto line_start = breaks == 0 ? 0 : before.rfind('\n') + 1;
  return {text.start.file, static_cast<int>(breaks) + 1, static_cast<int>(offset - line_start) + 1};
}

}  // namespace

SourceLocation place_in_string(const TomlString& text, std::size_t offset) {
  const auto within = place_within(text, offset);
  if (!text.anchors.empty()) return StringPlaces(text.text, text.anchors).in_file(within);
  const int column = within.line == 1 ? text.start.column + within.column - 1 : within.column;
  return {text.start.file, text.start.line + within.line - 1, column};
}

void TomlReader::fail(Error error) {
  const auto is_here = [&](const Error& other) { return same_place(other.location, error.location); };
  if (std::any_of(errors_.begin(), errors_.end(), is_here)) return;
  if (!table_.empty()) error = with_context(std::move(error), "in " + table_);
  errors_.push_back(std::move(error));
}

void TomlReader::wrong_type(std::string_view expected, const TomlValue& found, std::string remedy) {
  fail({ErrorCode::parse_failure,
        fmt::format("expected {}, found {}", expected, description_of(found)),
        std::move(remedy),
        found.location,
        {}});
}

void TomlReader::missing(std::string message, std::string remedy, const SourceLocation& location) {
  if (!has_unknown_key_) fail({ErrorCode::parse_failure, std::move(message), std::move(remedy), location, {}});
}

void TomlReader::unknown_key(const TomlEntry& entry, const std::vector<std::string>& known) {
  has_unknown_key_ = true;
  fail({ErrorCode::unknown_name,
        fmt::format("unknown key '{}'", entry.key),
        suggest_word(entry.key, known),
        entry.location,
        {}});
}

void TomlReader::not_available(const SourceLocation& location, std::string_view what) {
  fail({ErrorCode::not_available,
        fmt::format("{} is not available in this version; a later one brings it", what),
        "leave it out to run the rest of the model",
        location,
        {}});
}

const TomlTable* TomlReader::table(const TomlValue& value, std::string_view expected) {
  const auto* table = std::get_if<TomlTable>(&value.value);
  const auto* list = std::get_if<TomlArray>(&value.value);
  const bool is_doubled = list != nullptr && !list->empty() && std::holds_alternative<TomlTable>(list->front().value);
  if (is_doubled) {
    constexpr std::string_view has_name = "the table [";
    const auto name = expected.substr(0, expected.find(']')).substr(std::min(has_name.size(), expected.size()));
    wrong_type(expected, value,
               expected.starts_with(has_name) ? fmt::format("write [{}] in single brackets, once", name)
                                              : "write one table, without square brackets around it");
  } else if (table == nullptr) {
    wrong_type(expected, value);
  }
  return table;
}

const TomlArray& TomlReader::tables(const TomlValue& value, std::string_view name) {
  static const TomlArray none;
  const auto* array = std::get_if<TomlArray>(&value.value);
  if (array == nullptr) {
    wrong_type(fmt::format("tables that begin with [[{}]]", name), value,
               fmt::format("write [[{}]] in double brackets, before each of them", name));
  }
  return array != nullptr ? *array : none;
}

expression::NodePtr TomlReader::expression(const TomlValue& value) {
  if (const auto number = number_in(value)) {
    if (std::isfinite(*number)) return expression::number(*number, value.location);
    wrong_type("a finite number", value);
    return expression::unreadable(value.location);
  }
  const auto* text = std::get_if<TomlString>(&value.value);
  if (text == nullptr) {
    wrong_type(number_or_expression, value);
    return expression::unreadable(value.location);
  }
  const bool as_it_stands = text->anchors.empty();
  const StringPlaces places(text->text, text->anchors);
  auto tree = expression::parse(text->text, as_it_stands ? text->start : SourceLocation{text->start.file, 1, 1},
                                functions_, declared_);
  if (tree) return as_it_stands ? *tree : places.in_file(*tree);
  if (!as_it_stands) tree.error().location = places.in_file(tree.error().location);
  fail(tree.error());
  return expression::unreadable(tree.error().location);
}

expression::NodePtr TomlReader::expression_in(const TomlString& text, std::size_t offset, std::size_t length) {
  const auto part = std::string_view(text.text).substr(offset, length);
  const bool as_it_stands = text.anchors.empty();
  const StringPlaces places(text.text, text.anchors);
  auto tree = expression::parse(part, as_it_stands ? place_in_string(text, offset) : place_within(text, offset),
                                functions_, declared_);
  if (tree) return as_it_stands ? *tree : places.in_file(*tree);
  if (!as_it_stands) tree.error().location = places.in_file(tree.error().location);
  fail(tree.error());
  return expression::unreadable(tree.error().location);
}

expression::NodePtr TomlReader::bound(const TomlValue& value) {
  const auto number = number_in(value);
  if (number && std::isinf(*number)) return nullptr;
  return expression(value);
}

std::optional<double> TomlReader::number(const TomlValue& value) {
  const auto number = number_in(value);
  if (!number) wrong_type("a number", value);
  return number;
}

std::string TomlReader::string(const TomlValue& value, std::string_view expected) {
  if (const auto* text = std::get_if<TomlString>(&value.value)) return text->text;
  wrong_type(expected, value);
  return {};
}

bool TomlReader::boolean(const TomlValue& value) {
  if (const auto* truth = std::get_if<bool>(&value.value)) return *truth;
  wrong_type("true or false", value);
  return false;
}

}  // namespace saltus::io
