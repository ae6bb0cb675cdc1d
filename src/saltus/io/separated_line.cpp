#include <algorithm>

#include "saltus/base/text.hpp"
#include "saltus/io/separated_line_internal.hpp"

namespace saltus::io {

std::vector<std::string_view> separated_fields(std::string_view line) {
  char separator = ' ';
  for (const char candidate : {'\t', ',', ';'}) {
    if (line.find(candidate) != std::string_view::npos) separator = candidate;
  }
  std::vector<std::string_view> fields;
  for (std::size_t from = 0; from <= line.size();) {
    const auto to = std::min(line.find(separator, from), line.size());
    auto field = trimmed(line.substr(from, to - from), " \t");
    if (field.size() > 1 && field.front() == '"' && field.back() == '"') field = field.substr(1, field.size() - 2);
    if (separator != ' ' || !field.empty()) fields.push_back(field);
    from = to + 1;
  }
  return fields;
}

std::optional<double> separated_number(std::string_view field) { return whole_text_as<double>(without_plus(field)); }

}  // namespace saltus::io
