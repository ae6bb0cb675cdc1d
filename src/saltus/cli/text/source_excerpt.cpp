#include "saltus/cli/text/source_excerpt.hpp"

#include <algorithm>
#include <string_view>

#include <fmt/format.h>

#include "saltus/cli/text/terminal.hpp"

namespace saltus::cli {
namespace {

/// Longer lines are generated: nobody finds a place in them by eye.
constexpr std::size_t longest_line = 160;

std::string_view line_of(std::string_view text, int number) {
  for (int i = 1; i < number; ++i) {
    const auto end = text.find('\n');
    if (end == std::string_view::npos) return {};
    text.remove_prefix(end + 1);
  }
  return text.substr(0, text.find('\n'));
}

bool is_later_byte(char c) { return (static_cast<unsigned char>(c) & 0xC0U) == 0x80U; }

/// Whether the characters beyond ASCII are whole.
bool is_utf8(std::string_view line) {
  for (std::size_t i = 0; i < line.size();) {
    const auto lead = static_cast<unsigned char>(line[i++]);
    int later = lead < 0x80U ? 0 : lead < 0xC2U || lead > 0xF4U ? -1 : lead < 0xE0U ? 1 : lead < 0xF0U ? 2 : 3;
    if (later < 0) return false;
    for (; later > 0; --later, ++i) {
      if (i >= line.size() || !is_later_byte(line[i])) return false;
    }
  }
  return true;
}

/// Nothing that a terminal would obey; tabs are fine, so that the caret stands below its place.
bool is_plain(std::string_view line) {
  return std::none_of(line.begin(), line.end(),
                      [](char c) { return (static_cast<unsigned char>(c) < 0x20U && c != '\t') || c == '\x7F'; });
}

std::string excerpt(const SourceLocation& location, std::string_view text) {
  auto line = line_of(text, location.line);
  if (line.ends_with('\r')) line.remove_suffix(1);
  if (line.empty() || line.size() > longest_line || !is_plain(line) || !is_utf8(line)) return "";
  std::string below;
  int column = 1;
  for (std::size_t i = 0; i < line.size() && column < location.column; ++i) {
    if (is_later_byte(line[i])) continue;  // a later byte of a character
    below += line[i] == '\t' ? '\t' : ' ';
    ++column;
  }
  below.append(static_cast<std::size_t>(std::max(0, location.column - column)), ' ');
  return fmt::format("\n{:>5} | {}\n      | {}^", location.line, line, below);
}

}  // namespace

std::string with_source(const Error& error, const frontend::ModelText& source) {
  std::string text = to_text(error);
  if (error.location.file != source.name || error.location.line < 1 || error.location.column < 1) return text;
  const auto end = text.find('\n');
  return text.insert(end == std::string::npos ? text.size() : end, excerpt(error.location, source.text));
}

ExitCode refuse_with_source(const Error& error, const frontend::ModelText& source) {
  print_error(with_source(error, source));
  return ExitCode::bad_input;
}

}  // namespace saltus::cli
