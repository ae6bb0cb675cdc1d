#include <algorithm>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "saltus/base/text.hpp"
#include "saltus/expression/parser.hpp"
#include "saltus/io/constant_value_internal.hpp"
#include "saltus/io/option_text.hpp"
#include "saltus/io/setting_values_internal.hpp"

namespace saltus::io {
namespace {

std::optional<double> constant_in(std::string_view text) {
  if (const auto number = whole_text_as<double>(text)) return number;
  const auto tree = expression::parse(text, {});
  return tree ? constant_value(**tree) : std::nullopt;
}

/// Words between commas, in quotes or without.
std::vector<std::string> words_in(std::string_view text) {
  std::vector<std::string> words;
  while (!text.empty()) {
    const char quote = text.front() == '"' || text.front() == '\'' ? text.front() : '\0';
    const auto end = std::min(text.find(quote == '\0' ? ',' : quote, quote == '\0' ? 0 : 1), text.size());
    words.emplace_back(quote == '\0' ? trimmed(text.substr(0, end)) : text.substr(1, end - 1));
    text.remove_prefix(std::min(text.find(',', end), text.size()));
    text = trimmed(text.substr(std::min<std::size_t>(1, text.size())));
  }
  return words;
}

std::optional<std::vector<double>> list_in(std::string_view text) {
  if (!text.starts_with('[') || !text.ends_with(']')) return std::nullopt;
  text = text.substr(1, text.size() - 2);
  std::vector<double> list;
  while (!text.empty()) {
    const auto comma = std::min(text.find(','), text.size());
    const auto number = constant_in(trimmed(text.substr(0, comma)));
    if (!number) return std::nullopt;
    list.push_back(*number);
    text.remove_prefix(std::min(comma + 1, text.size()));
  }
  return list;
}

}  // namespace

result::OptionValue option_value(std::string_view text) {
  text = trimmed(text);
  if (text == "true" || text == "false") return text == "true";
  if (const auto integer = whole_text_as<std::int64_t>(text)) return *integer;
  if (const auto number = constant_in(text)) return *number;
  if (auto list = list_in(text)) return std::move(*list);
  if (text.starts_with('[') && text.ends_with(']')) return words_in(trimmed(text.substr(1, text.size() - 2)));
  return std::string(text);
}

SourceLocation place_of_setting(std::string_view key) { return {fmt::format("--set {}", key), 0, 0}; }

tl::unexpected<Error> refused_setting(std::string_view key, ErrorCode code, std::string message, std::string remedy) {
  return tl::unexpected(Error{code, std::move(message), std::move(remedy), place_of_setting(key), {}});
}

}  // namespace saltus::io
