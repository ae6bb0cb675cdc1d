#include <algorithm>
#include <charconv>

#include "saltus/io/separated_line_internal.hpp"

namespace saltus::io {

std::vector<std::string_view> separated_fields(std::string_view line) {
  char separator = ' ';
  for (const char candidate : {'\t', ',', ';'}) {
    if (line.find(candidate) != std::string_view::npos) separator = candidate;
  }
  std::vector<std::string_view> fields;
  const auto is_blank = [](char c) { return c == ' ' || c == '\t'; };
  for (std::size_t from = 0; from <= line.size();) {
    const auto to = std::min(line.find(separator, from), line.size());
    auto field = line.substr(from, to - from);
    while (!field.empty() && is_blank(field.front())) field.remove_prefix(1);
    while (!field.empty() && is_blank(field.back())) field.remove_suffix(1);
    if (field.size() > 1 && field.front() == '"' && field.back() == '"') field = field.substr(1, field.size() - 2);
    if (separator != ' ' || !field.empty()) fields.push_back(field);
    from = to + 1;
  }
  return fields;
}

std::optional<double> separated_number(std::string_view field) {
  if (field.size() > 1 && field.front() == '+') field.remove_prefix(1);
  double value = 0.0;
  const auto [end, failure] = std::from_chars(field.data(), field.data() + field.size(), value);
  if (failure != std::errc{} || end != field.data() + field.size()) return std::nullopt;
  return value;
}

}  // namespace saltus::io
