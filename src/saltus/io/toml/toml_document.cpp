#include <algorithm>
#include <cctype>
#include <cstddef>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <toml++/toml.h>

#include "saltus/base/text.hpp"
#include "saltus/io/text_encoding_internal.hpp"
#include "saltus/io/toml/toml_document_internal.hpp"
#include "saltus/io/toml/toml_slips_internal.hpp"

namespace saltus::io {
namespace {

/// Finds what stands at a position of toml++, whose columns count characters, not bytes.
class SourceText {
 public:
  SourceText(std::string_view text, std::string file) : text_(text), file_(std::move(file)), line_starts_{0} {
    for (std::size_t i = 0; i < text.size(); ++i) {
      if (text[i] == '\n') line_starts_.push_back(i + 1);
    }
  }

  [[nodiscard]] SourceLocation location(const toml::source_position& position) const {
    return {file_, static_cast<int>(position.line), static_cast<int>(position.column)};
  }

  /// The text from a position on; empty if there is none.
  [[nodiscard]] std::string_view from(const toml::source_position& position) const {
    if (position.line < 1 || position.line > line_starts_.size()) return {};
    std::size_t offset = line_starts_[position.line - 1];
    for (std::size_t column = 1; column < position.column && offset < text_.size(); ++column) {
      ++offset;
      while (offset < text_.size() && (static_cast<unsigned char>(text_[offset]) & 0xC0) == 0x80) ++offset;
    }
    return text_.substr(std::min(offset, text_.size()));
  }

  [[nodiscard]] std::string_view line(std::size_t number) const {
    if (number < 1 || number > line_starts_.size()) return {};
    const auto rest = text_.substr(line_starts_[number - 1]);
    return rest.substr(0, rest.find('\n'));
  }

 private:
  std::string_view text_;
  std::string file_;
  std::vector<std::size_t> line_starts_;
};

/// A string with the places of its characters.
TomlString placed_string(const SourceText& source, const toml::source_position& begin, const std::string& text) {
  TomlString result{text, source.location(begin), {}};
  auto raw = source.from(begin);
  const bool is_basic = raw.starts_with('"');
  const bool multi_line = raw.starts_with("\"\"\"") || raw.starts_with("'''");
  const std::size_t quotes = multi_line ? 3 : (is_basic || raw.starts_with('\'') ? 1 : 0);
  raw.remove_prefix(quotes);
  result.start.column += static_cast<int>(quotes);
  if (multi_line && (raw.starts_with('\n') || raw.starts_with("\r\n"))) {  // TOML drops the first line break
    raw.remove_prefix(raw.find('\n') + 1);
    result.start = {result.start.file, result.start.line + 1, 1};
  }
  if (is_basic) result.anchors = anchors_of(raw, result.start, multi_line);
  return result;
}

/// Deeper than any table of a model file; what lies below is left out, since nothing reads there.
constexpr int most_levels = 16;

TomlTable converted(const SourceText& source, const toml::table& table, int level);

TomlValue converted(const SourceText& source, const toml::node& node, int level) {
  TomlValue result{TomlDate{}, source.location(node.source().begin)};
  if (const auto* truth = node.as_boolean()) {
    result.value = truth->get();
  } else if (const auto* integer = node.as_integer()) {
    result.value = integer->get();
  } else if (const auto* real = node.as_floating_point()) {
    result.value = real->get();
  } else if (const auto* text = node.as_string()) {
    result.value = placed_string(source, node.source().begin, text->get());
  } else if (const auto* array = node.as_array()) {
    TomlArray elements;
    if (level < most_levels) {
      for (const auto& element : *array) elements.push_back(converted(source, element, level + 1));
    }
    result.value = std::move(elements);
  } else if (const auto* table = node.as_table()) {
    result.value = level < most_levels ? converted(source, *table, level + 1) : TomlTable{};
  }
  return result;
}

TomlTable converted(const SourceText& source, const toml::table& table, int level) {
  TomlTable entries;
  for (const auto& [key, node] : table) {
    auto position = key.source().begin;
    if (!position) position = node.source().begin;
    entries.push_back({std::string(key.str()), source.location(position), converted(source, node, level)});
  }
  std::stable_sort(entries.begin(), entries.end(), [](const TomlEntry& a, const TomlEntry& b) {
    return std::pair(a.location.line, a.location.column) < std::pair(b.location.line, b.location.column);
  });
  return entries;
}

/// More parts than any key of a model file has. toml++ bounds the depth of brackets (256), not that of dotted keys, and
/// destroys its tree recursively: this keeps it below some ten thousand levels.
constexpr int most_parts = 32;

/// Whether a line has a longer chain of names with dots between, wherever it stands.
bool has_endless_key(std::string_view text) {
  int parts = 1;
  char last = '\n';
  for (const char c : text) {
    const bool in_name = std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-' || c == '"' ||
                         c == '\'' || c == ' ' || c == '\t';
    if (c == '.' && last != '.') {
      if (++parts > most_parts) return true;
    } else if (!in_name) {
      parts = 1;
    }
    last = c;
  }
  return false;
}

Error toml_syntax_error(const SourceText& source, const toml::parse_error& failure) {
  const auto& position = failure.source().begin;
  auto slip = slip_in(source.line(position.line), position.column, failure.description());
  return {ErrorCode::parse_failure, std::move(slip.message), std::move(slip.remedy), source.location(position), {}};
}

}  // namespace

Expected<TomlTable> parse_toml(std::string_view text, const std::string& file) {
  constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";  // of UTF-8: some editors begin every file with it
  if (text.starts_with(byte_order_mark)) text.remove_prefix(byte_order_mark.size());
  if (auto readable = check_encoding(text, file); !readable) return tl::unexpected(readable.error());
  if (has_endless_key(text)) {
    return tl::unexpected(Error{ErrorCode::parse_failure,
                                fmt::format("a key has more than {} parts", most_parts),
                                "keys of a model file have one to four, like simulate.event.integrator",
                                {file, 0, 0},
                                {}});
  }
  const SourceText source(text, file);
  try {
    return converted(source, toml::parse(text, file), 0);
  } catch (const toml::parse_error& failure) {
    return tl::unexpected(toml_syntax_error(source, failure));
  }
}

std::string description_of(const TomlValue& value) {
  struct Describe {
    std::string operator()(bool truth) const { return truth ? "true" : "false"; }
    std::string operator()(std::int64_t number) const { return fmt::format("the number {}", number); }
    std::string operator()(double number) const { return fmt::format("the number {}", number); }
    std::string operator()(const TomlString& string) const {
      constexpr std::size_t shown = 40;
      const bool whole = string.text.size() <= shown;
      return fmt::format("the string \"{}{}\"", string.text.substr(0, shown), whole ? "" : "…");
    }
    std::string operator()(TomlDate) const { return "a date or time"; }
    std::string operator()(const TomlArray&) const { return "a list"; }
    std::string operator()(const TomlTable&) const { return "a table"; }
  };
  return std::visit(Describe{}, value.value);
}

}  // namespace saltus::io
