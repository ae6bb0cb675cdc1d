#include <algorithm>
#include <cctype>
#include <charconv>
#include <optional>
#include <string>
#include <utility>

#include "saltus/io/check/option_schema_internal.hpp"

namespace saltus::io {
namespace {

bool is_word(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(),
                                      [](unsigned char c) { return std::isalnum(c) != 0 || c == '_' || c == '-'; });
}

std::optional<double> number_behind(std::string_view text, std::string_view sign) {
  const auto place = text.find(sign);
  if (place == std::string_view::npos) return std::nullopt;
  const auto rest = text.substr(place + sign.size());
  double value = 0.0;
  if (std::from_chars(rest.data(), rest.data() + rest.size(), value).ec != std::errc()) return std::nullopt;
  return value;
}

/// "a number > 0 and <= 1"
Json number_schema(std::string_view expects) {
  Json json = {{"type", "number"}};
  if (expects.starts_with("a whole")) json["multipleOf"] = 1;
  constexpr std::pair<std::string_view, std::string_view> bounds[] = {
      {" > ", "exclusiveMinimum"}, {" >= ", "minimum"}, {" < ", "exclusiveMaximum"}, {" <= ", "maximum"}};
  for (const auto& [sign, key] : bounds) {
    if (const auto bound = number_behind(expects, sign)) json[std::string(key)] = *bound;
  }
  return json;
}

/// "report, all"; what is no list of words says nothing.
Json word_schema(std::string_view expects) {
  Json words = Json::array();
  while (!expects.empty()) {
    const auto comma = expects.find(", ");
    auto word = expects.substr(0, comma);
    expects = comma == std::string_view::npos ? std::string_view() : expects.substr(comma + 2);
    if (word.size() > 2 && word.front() == '"' && word.back() == '"') word = word.substr(1, word.size() - 2);
    if (!is_word(word)) return Json::object();
    int number = 0;
    const auto [end, problem] = std::from_chars(word.data(), word.data() + word.size(), number);
    const bool whole = problem == std::errc() && end == word.data() + word.size();
    words.push_back(whole ? Json(number) : Json(word));
  }
  return {{"enum", std::move(words)}};
}

Json part_schema(std::string_view expects) {
  if (expects == "true or false" || expects == "true, false") return {{"type", "boolean"}};
  if (expects.starts_with("a list")) return {{"type", "array"}};
  const bool number = expects.starts_with("a number") || expects.starts_with("a finite number") ||
                      expects.starts_with("a whole number");
  return number ? number_schema(expects) : word_schema(expects);
}

}  // namespace

Json option_schema(std::string_view expects) {
  constexpr std::string_view either = ", or ";
  Json parts = Json::array();
  for (auto rest = expects;;) {
    const auto place = rest.find(either);
    auto part = part_schema(rest.substr(0, place));
    if (part.empty()) return part;
    parts.push_back(std::move(part));
    if (place == std::string_view::npos) break;
    rest = rest.substr(place + either.size());
  }
  if (parts.size() == 1) return parts.front();
  return {{"anyOf", std::move(parts)}};
}

}  // namespace saltus::io
