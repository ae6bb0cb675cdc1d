#include <algorithm>
#include <charconv>
#include <cstdint>
#include <memory>
#include <variant>

#include "saltus/io/toml/string_places_internal.hpp"

namespace saltus::io {
namespace {

/// Bytes of a character in UTF-8.
std::size_t encoded_size(std::uint32_t character) {
  if (character < 0x80U) return 1;
  if (character < 0x800U) return 2;
  return character < 0x10000U ? 3 : 4;
}

struct Escape {
  std::size_t written = 2;  ///< bytes in the file
  std::size_t value = 1;    ///< bytes in the string
};

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

/// The escape that `raw` begins with; toml++ has accepted it.
Escape escape_at(std::string_view raw) {
  const char kind = raw.size() > 1 ? raw[1] : '\0';
  if (kind == 'u' || kind == 'U') {
    const std::size_t digits = kind == 'u' ? 4 : 8;
    std::uint32_t character = 0;
    const auto code = raw.substr(2, digits);
    std::from_chars(code.data(), code.data() + code.size(), character, 16);
    return {2 + digits, encoded_size(character)};
  }
  if (!is_blank(kind)) return {};
  const auto next = raw.substr(1);  // the backslash at the end of a line: blanks up to the next text are left out
  const auto blanks = std::find_if_not(next.begin(), next.end(), is_blank) - next.begin();
  return {1 + static_cast<std::size_t>(blanks), 0};
}

void advance(SourceLocation& place, std::string_view text) {
  for (const char c : text) {
    if (c == '\n') {
      ++place.line;
      place.column = 1;
    } else if ((static_cast<unsigned char>(c) & 0xC0U) != 0x80U) {
      ++place.column;
    }
  }
}

}  // namespace

std::vector<StringAnchor> anchors_of(std::string_view raw, const SourceLocation& start, bool multi_line) {
  const std::string_view closing = multi_line ? R"(""")" : R"(")";
  std::vector<StringAnchor> anchors{{0, start}};
  SourceLocation place = start;
  std::size_t offset = 0;
  while (!raw.empty() && !raw.starts_with(closing)) {
    const bool escaped = raw.front() == '\\';
    const auto [written, value] = escaped ? escape_at(raw) : Escape{1, 1};
    const auto text = raw.substr(0, written);
    advance(place, text);
    raw.remove_prefix(text.size());
    offset += value;
    if (escaped) anchors.push_back({offset, place});
  }
  if (anchors.size() == 1) anchors.clear();
  return anchors;
}

SourceLocation StringPlaces::in_file(const SourceLocation& location) const {
  std::size_t offset = 0;
  for (int line = 1; line < location.line; ++line) {
    offset = std::min(value_.find('\n', offset), value_.size() - 1) + 1;
  }
  offset = std::min(offset + static_cast<std::size_t>(std::max(location.column, 1) - 1), value_.size());
  const auto behind = std::upper_bound(anchors_.begin(), anchors_.end(), offset,
                                       [](std::size_t place, const auto& anchor) { return place < anchor.offset; });
  const auto& anchor = *(behind - 1);
  SourceLocation place = anchor.place;
  advance(place, value_.substr(anchor.offset, offset - anchor.offset));
  return place;
}

expression::NodePtr StringPlaces::in_file(const expression::NodePtr& tree) const {
  auto copy = std::make_shared<expression::Node>(*tree);
  copy->location = in_file(tree->location);
  if (auto* unary = std::get_if<expression::Unary>(&copy->value)) {
    unary->operand = in_file(unary->operand);
  } else if (auto* binary = std::get_if<expression::Binary>(&copy->value)) {
    binary->left = in_file(binary->left);
    binary->right = in_file(binary->right);
  } else if (auto* call = std::get_if<expression::Call>(&copy->value)) {
    for (auto& argument : call->arguments) argument = in_file(argument);
  }
  return copy;
}

}  // namespace saltus::io
