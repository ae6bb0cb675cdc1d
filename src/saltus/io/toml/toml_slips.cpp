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

/// A line without its comment, with what stands before and behind its first equals sign, and what its reader said.
struct Line {
  std::string_view text, key, value;
  bool is_assignment;
  std::string_view rest;  ///< from where its reader stopped
  std::string_view said;

  [[nodiscard]] bool says(std::string_view part) const { return said.find(part) != std::string_view::npos; }
};

/// Its end, or where its comment begins.
std::size_t end_of_code(std::string_view line) {
  char quote = '\0';
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (quote == '\0' && c == '#') return i;
    if (quote == '"' && c == '\\') {
      ++i;
    } else if (c == quote) {
      quote = '\0';
    } else if (quote == '\0' && (c == '"' || c == '\'')) {
      quote = c;
    }
  }
  return line.size();
}

/// The line from a column on; columns count characters.
std::string_view from_column(std::string_view line, std::size_t column) {
  const auto begins = [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; };
  std::size_t at = 0;
  for (std::size_t i = 1; i < column && at < line.size(); ++i) {
    do ++at;
    while (at < line.size() && !begins(line[at]));
  }
  return line.substr(at);
}

bool is_digits(std::string_view text) {
  return !text.empty() && text.find_first_not_of("0123456789") == std::string_view::npos;
}

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
  if (!trimmed(line.rest, blanks).empty() || !line.says("control characters")) return std::nullopt;
  return Slip{invalid("a text in quotes does not end on its line"), "close the quotes where the text ends"};
}

/// mass = 1 [kg], T = 300 K;
std::optional<Slip> unit_behind_number(const Line& line) {
  const auto space = line.value.find_first_of(blanks);
  if (space == std::string_view::npos || line.value.find_first_not_of("0123456789.eE+-_") != space) return std::nullopt;
  auto unit = trimmed(line.value.substr(space), " \t\r;");
  if (unit.starts_with('[') && unit.ends_with(']')) unit = unit.substr(1, unit.size() - 2);
  const bool is_word = !unit.empty() && (std::isalpha(static_cast<unsigned char>(unit.front())) != 0 ||
                                         static_cast<unsigned char>(unit.front()) >= 0x80U);
  if (!is_word || unit.find_first_of("\"'=[]{}(),") != std::string_view::npos) return std::nullopt;
  return Slip{invalid(fmt::format("'{}' behind a number", unit)),
              fmt::format("a unit is a text of its own: {} = {{ initial = {}, unit = \"{}\" }}", line.key,
                          line.value.substr(0, space), unit)};
}

/// x' = 1, x'' = 1
std::optional<Slip> prime(const Line& line) {
  const auto name = line.key.substr(0, line.key.find('\''));
  const auto primes = line.key.substr(name.size());
  const bool primed = !name.empty() && !primes.empty() && primes.find_first_not_of('\'') == std::string_view::npos;
  if (!primed || !line.says("expected '='")) return std::nullopt;
  if (primes.size() > 1) {
    return Slip{
        invalid(shortened(line.said)),
        fmt::format("the first derivative is a state of its own: add v to [states], with {} = \"v\" and v = \"…\"",
                    name)};
  }
  return Slip{invalid(shortened(line.said)),
              fmt::format("right-hand sides stand under the state's name, without a prime: {} = \"…\"", name)};
}

/// dx/dt = 1
std::optional<Slip> quotient(const Line& line) {
  if (!line.key.starts_with('d') || !line.key.ends_with("/dt") || line.key.size() < 5) return std::nullopt;
  return Slip{invalid(fmt::format("the name '{}'", line.key)),
              fmt::format("right-hand sides stand under the state's name: {} = \"…\"",
                          trimmed(line.key.substr(1, line.key.size() - 4), blanks))};
}

/// x(0) = 1
std::optional<Slip> start(const Line& line) {
  const auto open = line.key.find('(');
  if (!line.is_assignment || open == 0 || open == std::string_view::npos || !line.key.ends_with(')'))
    return std::nullopt;
  return Slip{invalid(fmt::format("the name '{}'", line.key)),
              fmt::format("names stand without parentheses: an initial value is {} = 1 under [states]",
                          trimmed(line.key.substr(0, open), blanks))};
}

/// mu k = 2, μ = 2
std::optional<Slip> key_without_quotes(const Line& line) {
  if (!line.is_assignment || is_plain_name(line.key) || line.key.find_first_of("[]{}\"'%") < line.key.size())
    return std::nullopt;
  return Slip{invalid(fmt::format("the name '{}'", line.key)),
              "names consist of the letters a to z, digits and underscores; what pictures call them is a label: "
              "mu_k = { initial = 2, label = \"μ k\" }"};
}

/// x: 1, x := 1
std::optional<Slip> colon(const Line& line) {
  if (!line.says("expected '=', saw ':'")) return std::nullopt;
  return Slip{invalid(shortened(line.said)), fmt::format("values stand behind an equals sign: {} = …",
                                                         trimmed(line.text.substr(0, line.text.find(':')), blanks))};
}

std::optional<Slip> other_comment(const Line& line) {
  const bool is_line = line.text.find_first_of("%/;!") == 0;
  if (!is_line && !line.rest.starts_with("//") && !line.rest.starts_with('%')) return std::nullopt;
  return Slip{invalid(shortened(line.said)), "a comment begins with #"};
}

/// 0,8 and -1,5e3 with a decimal sign, 1,000,000.5 with commas between thousands, 1,000 with either.
std::optional<Slip> comma_in_number(const Line& line) {
  const auto comma = line.value.find(',');
  const auto sign = std::min<std::size_t>(line.value.find_first_not_of("+-"), 1);
  if (comma == std::string_view::npos || !is_digits(line.value.substr(sign, comma - sign))) return std::nullopt;
  std::string joined(line.value.substr(0, comma));
  const auto pieces = split(line.value.substr(comma + 1), ',');
  bool by_thousands = true;
  for (const auto piece : pieces) {
    const auto end = std::min(piece.find_first_of(".eE"), piece.size());
    if (!is_digits(piece.substr(0, end))) return std::nullopt;
    by_thousands = by_thousands && end == 3;
    joined += piece;
  }
  if (!whole_text_as<double>(without_plus(joined))) return std::nullopt;
  const bool by_point = pieces.size() == 1 && pieces.front().find('.') == std::string_view::npos;
  if (!by_thousands && !by_point) return std::nullopt;
  const auto point =
      fmt::format("the decimal sign is a point: {} = {}.{}", line.key, line.value.substr(0, comma), pieces.front());
  const auto plain = fmt::format("no commas stand between thousands: {} = {}", line.key, joined);
  return Slip{invalid("a comma in a number"), !by_thousands ? point : by_point ? plain + "; " + point : plain};
}

std::optional<Slip> number(const Line& line) {
  if (line.says("expected decimal digit")) {
    const auto digits = line.value.find_last_not_of("+-");
    const bool has_exponent =
        digits != std::string_view::npos && (line.value[digits] == 'e' || line.value[digits] == 'E');
    return Slip{invalid(shortened(line.said)), has_exponent
                                                   ? "an exponent has digits: 1e3, 1e-3"
                                                   : "a number has a digit on both sides of its point: 0.5, 5.0"};
  }
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
  const bool is_absent = line.is_assignment && line.value.empty() && !line.key.empty();
  if (is_absent && (line.says("expected value") || line.says("end-of-file")))
    return mended(fmt::format("write the value behind the equals sign: {} = …", line.key));
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

bool is_plain_name(std::string_view key) {
  return std::all_of(key.begin(), key.end(), [](unsigned char c) {
    return c < 0x80U && (std::isalnum(c) != 0 || c == '_' || c == '-' || c == '.');
  });
}

Slip slip_in(std::string_view line, std::size_t column, std::string_view description) {
  const auto code = trimmed(line.substr(0, end_of_code(line)), blanks);
  const auto equal = std::min(code.find('='), code.size());
  const bool is_assignment = equal < code.size();
  const Line parts{code,
                   trimmed(code.substr(0, equal), blanks),
                   is_assignment ? trimmed(code.substr(equal + 1), blanks) : std::string_view(),
                   is_assignment,
                   from_column(line, column),
                   description};
  constexpr std::array usual{typographic_quotes,
                             open_text,
                             unit_behind_number,
                             prime,
                             quotient,
                             other_comment,
                             comma_in_number,
                             number,
                             colon,
                             start,
                             key_without_quotes,
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
