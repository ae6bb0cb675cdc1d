#include <algorithm>
#include <array>
#include <cctype>
#include <optional>

#include <fmt/format.h>

#include "saltus/base/text.hpp"
#include "saltus/io/toml/toml_slips_internal.hpp"

namespace saltus::io {
namespace {

constexpr std::string_view blanks = " \t\r";

/// A line with what stands before and behind its first equals sign, and what its reader said.
struct Line {
  std::string_view text, key, value;
  std::size_t column;
  std::string_view said;

  [[nodiscard]] bool is_assignment() const { return key.size() < text.size(); }
  [[nodiscard]] bool says(std::string_view part) const { return said.find(part) != std::string_view::npos; }
};

/// Without "Error while parsing value: ": that it is an error stands there already, and the place, too.
std::string_view shortened(std::string_view description) {
  constexpr std::string_view prefix = "Error while parsing ";
  const auto colon = description.find(": ");
  const bool has_prefix = description.starts_with(prefix) && colon != std::string_view::npos;
  return has_prefix ? description.substr(colon + 2) : description;
}

std::string invalid(std::string_view what) { return fmt::format("not valid TOML: {}", what); }

std::optional<Slip> typographic_quotes(const Line& line) {
  for (const std::string_view quote : {"\u201C", "\u201D", "\u2018", "\u2019"}) {
    if (line.text.find(quote) == std::string_view::npos) continue;
    return Slip{invalid(fmt::format("typographic quotes ({})", quote)), "write straight quotes: x = \"-x\""};
  }
  return std::nullopt;
}

std::optional<Slip> open_text(const Line& line) {
  if (line.column <= line.text.size() || !line.says("control characters")) return std::nullopt;
  return Slip{invalid("a text in quotes does not end on its line"), "close the quotes where the text ends"};
}

/// mass = 1 [kg], T = 300 K
std::optional<Slip> unit_behind_number(const Line& line) {
  const auto space = line.value.find_first_of(blanks);
  if (space == std::string_view::npos || line.value.find_first_not_of("0123456789.eE+-_") != space) return std::nullopt;
  auto unit = trimmed(line.value.substr(space), blanks);
  if (unit.starts_with('[') && unit.ends_with(']')) unit = unit.substr(1, unit.size() - 2);
  const bool is_word = !unit.empty() && (std::isalpha(static_cast<unsigned char>(unit.front())) != 0 ||
                                         static_cast<unsigned char>(unit.front()) >= 0x80U);
  if (!is_word || unit.find_first_of("\"'=[]{}(),") != std::string_view::npos) return std::nullopt;
  return Slip{invalid(fmt::format("'{}' behind a number", unit)),
              fmt::format("a unit is a text of its own: {} = {{ initial = {}, unit = \"{}\" }}", line.key,
                          line.value.substr(0, space), unit)};
}

std::optional<Slip> prime(const Line& line) {
  const bool primed = line.key.ends_with('\'') && line.key.size() > 1 && line.says("expected '='");
  if (!primed) return std::nullopt;
  return Slip{invalid(shortened(line.said)),
              fmt::format("right-hand sides stand under the state's name, without a prime: {} = \"…\"",
                          line.key.substr(0, line.key.size() - 1))};
}

/// dx/dt = 1
std::optional<Slip> quotient(const Line& line) {
  if (!line.key.starts_with('d') || !line.key.ends_with("/dt") || line.key.size() < 5) return std::nullopt;
  return Slip{invalid(fmt::format("the name '{}'", line.key)),
              fmt::format("right-hand sides stand under the state's name: {} = \"…\"",
                          line.key.substr(1, line.key.size() - 4))};
}

/// mu k = 2, μ = 2
std::optional<Slip> key_without_quotes(const Line& line) {
  constexpr std::string_view letters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-.";
  const auto odd = line.key.find_first_not_of(letters);
  if (!line.is_assignment() || odd == std::string_view::npos || line.key.find_first_of("[]{}\"'#%") < line.key.size())
    return std::nullopt;
  return Slip{invalid(fmt::format("the name '{}'", line.key)),
              "names consist of the letters a to z, digits and underscores; what pictures call them is a label: "
              "mu_k = { initial = 2, label = \"μ k\" }"};
}

std::optional<Slip> colon(const Line& line) {
  const auto name = trimmed(line.text.substr(0, line.text.find(':')), blanks);
  if (line.is_assignment() || !line.says("expected '=', saw ':'")) return std::nullopt;
  return Slip{invalid(shortened(line.said)), fmt::format("values stand behind an equals sign: {} = …", name)};
}

std::optional<Slip> other_comment(const Line& line) {
  const bool is_line = line.text.find_first_not_of(blanks) == line.text.find_first_of("%/;!");
  const auto slashes = line.value.find("//");
  if (!is_line && (slashes == std::string_view::npos || line.value.find_first_of("\"'") < slashes)) return std::nullopt;
  return Slip{invalid(shortened(line.said)), "a comment begins with #"};
}

std::optional<Slip> number(const Line& line) {
  const auto comma = line.value.find(',');
  const auto is_digits = [](std::string_view text) {
    return !text.empty() && text.find_first_not_of("0123456789") == std::string_view::npos;
  };
  if (comma != std::string_view::npos && is_digits(line.value.substr(0, comma)) &&
      is_digits(line.value.substr(comma + 1))) {
    return Slip{invalid("a comma in a number"), fmt::format("the decimal sign is a point: {} = {}.{}", line.key,
                                                            line.value.substr(0, comma), line.value.substr(comma + 1))};
  }
  if (line.says("expected decimal digit"))
    return Slip{invalid(shortened(line.said)), "a number has a digit on both sides of its point: 0.5, 5.0"};
  if (line.says("leading zeroes"))
    return Slip{invalid(shortened(line.said)), "write the number without the zeros before it"};
  return std::nullopt;
}

std::optional<Slip> semicolon(const Line& line) {
  if (!line.value.ends_with(';')) return std::nullopt;
  return Slip{invalid(shortened(line.said)), "a line ends without a semicolon"};
}

/// True and False of Python, and brackets that span lines.
std::optional<Slip> other_value(const Line& line) {
  const auto mended = [&](std::string_view remedy) { return Slip{invalid(shortened(line.said)), std::string(remedy)}; };
  if (line.value == "True" || line.value == "False") return mended("write true or false, in small letters");
  if (line.says("end-of-file")) return mended("a bracket or a text in quotes is not closed");
  if (line.says("closing '}'") && line.value.find('}') == std::string_view::npos)
    return mended("a table in braces stands in one line: x = { initial = 1, lower = 0 }");
  if (line.says("cannot redefine")) return mended("every name stands once in its table: remove or rename one of them");
  return std::nullopt;
}

/// The habit of leaving the quotes away: x = -x + 1, x = sin(t).
std::optional<Slip> bare_expression(const Line& line) {
  if (line.says("could not be interpreted as a value") || line.value.empty()) return std::nullopt;
  if (std::string_view("\"'[{").find(line.value.front()) != std::string_view::npos) return std::nullopt;
  const bool has_letters =
      std::any_of(line.value.begin(), line.value.end(), [](unsigned char c) { return std::isalpha(c) != 0; });
  if (!has_letters && line.value.find_first_of("+-*/^(") == std::string_view::npos) return std::nullopt;
  return Slip{invalid(shortened(line.said)), "expressions stand in quotes: x = \"-x + sin(t)\""};
}

}  // namespace

Slip slip_in(std::string_view line, std::size_t column, std::string_view description) {
  const auto equal = std::min(line.find('='), line.size());
  const auto behind = line.substr(std::min(equal + 1, line.size()));
  const Line parts{line, trimmed(line.substr(0, equal), blanks), trimmed(behind.substr(0, behind.find('#')), blanks),
                   column, description};
  constexpr std::array usual{typographic_quotes,
                             open_text,
                             unit_behind_number,
                             prime,
                             quotient,
                             other_comment,
                             key_without_quotes,
                             colon,
                             number,
                             semicolon,
                             other_value,
                             bare_expression};
  for (const auto& slip : usual) {
    if (auto found = slip(parts)) return std::move(*found);
  }
  return {invalid(shortened(description)),
          "a line is a table, [states], or a name with its value, x = 1; texts and expressions stand in quotes "
          "(TOML: see toml.io)"};
}

}  // namespace saltus::io
