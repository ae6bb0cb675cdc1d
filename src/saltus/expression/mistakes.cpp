#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>

#include <fmt/format.h>

#include "saltus/expression/mistakes_internal.hpp"

namespace saltus::expression {
namespace {

constexpr std::array long_mistakes{
    // Longer ones first: the first match is taken.
    SymbolMistake{"===", "compare with '=='"},
    SymbolMistake{"!==", "compare with '!='"},
    SymbolMistake{"**", "write '^' for powers"},
    SymbolMistake{"&&", "write 'and'"},
    SymbolMistake{"||", "write 'or'; an absolute value is abs(x)"},
    SymbolMistake{"=>", "write '>='"},
    SymbolMistake{"=<", "write '<='"},
    SymbolMistake{"<>", "write '!='"},
    SymbolMistake{"~=", "write '!='"},
    SymbolMistake{"//", "write floor(a/b)"},
};

constexpr std::array short_mistakes{
    SymbolMistake{"=", "an expression assigns nothing: compare with '==' or, if both sides move, with '>=' or '<='"},
    SymbolMistake{"!", "write 'not'"},
    SymbolMistake{"~", "write 'not'"},
    SymbolMistake{"&", "write 'and'"},
    SymbolMistake{"|", "write 'or'; an absolute value is abs(x)"},
    SymbolMistake{"%", "write mod(a, b)"},
    SymbolMistake{"?", "write if(condition, a, b)"},
    SymbolMistake{":", "write if(condition, a, b)"},
    SymbolMistake{"[", "group with parentheses ( )"},
    SymbolMistake{"]", "group with parentheses ( )"},
    SymbolMistake{"{", "group with parentheses ( )"},
    SymbolMistake{"}", "group with parentheses ( )"},
    SymbolMistake{";", "separate arguments with ','; one text holds one expression"},
    SymbolMistake{".", "names consist of letters, digits and '_'; a number needs a digit, as in 0.5"},
    SymbolMistake{"'", "no quotes inside an expression; a derivative is an entry of [dynamics]"},
    SymbolMistake{"\"", "no quotes inside an expression"},
    SymbolMistake{"#", "put comments behind the closing quote"},
};

template <std::size_t n>
const SymbolMistake* first_match(const std::array<SymbolMistake, n>& mistakes, std::string_view rest) {
  const auto found = std::find_if(mistakes.begin(), mistakes.end(),
                                  [&](const SymbolMistake& mistake) { return rest.starts_with(mistake.text); });
  return found == mistakes.end() ? nullptr : &*found;
}

struct NamedCharacter {
  char32_t code;
  std::string_view name;
  std::string_view remedy;
};

constexpr std::array named_characters{
    NamedCharacter{0x2212, "minus sign", "write '-'"},
    NamedCharacter{0x2010, "hyphen", "write '-'"},
    NamedCharacter{0x2011, "non-breaking hyphen", "write '-'"},
    NamedCharacter{0x2013, "en dash", "write '-'"},
    NamedCharacter{0x2014, "em dash", "write '-'"},
    NamedCharacter{0x00D7, "multiplication sign", "write '*'"},
    NamedCharacter{0x00B7, "middle dot", "write '*'"},
    NamedCharacter{0x22C5, "dot operator", "write '*'"},
    NamedCharacter{0x2217, "asterisk operator", "write '*'"},
    NamedCharacter{0x2022, "bullet", "write '*'"},
    NamedCharacter{0x00F7, "division sign", "write '/'"},
    NamedCharacter{0x2044, "fraction slash", "write '/'"},
    NamedCharacter{0x2215, "division slash", "write '/'"},
    NamedCharacter{0x2264, "less-than or equal to", "write '<='"},
    NamedCharacter{0x2265, "greater-than or equal to", "write '>='"},
    NamedCharacter{0x2260, "not equal to", "write '!='"},
    NamedCharacter{0x2227, "logical and", "write 'and'"},
    NamedCharacter{0x2228, "logical or", "write 'or'"},
    NamedCharacter{0x00AC, "not sign", "write 'not'"},
    NamedCharacter{0x00B2, "superscript two", "write '^2'"},
    NamedCharacter{0x00B3, "superscript three", "write '^3'"},
    NamedCharacter{0x00BD, "one half", "write '0.5'"},
    NamedCharacter{0x221A, "square root", "write sqrt(x)"},
    NamedCharacter{0x221E, "infinity", "write a number; a bound that is left out is infinite"},
    NamedCharacter{0x00A0, "no-break space", "write an ordinary space"},
    NamedCharacter{0x2009, "thin space", "write an ordinary space"},
    NamedCharacter{0x202F, "narrow no-break space", "write an ordinary space"},
    NamedCharacter{0x3000, "ideographic space", "write an ordinary space"},
    NamedCharacter{0x200B, "zero width space", "delete it"},
    NamedCharacter{0xFEFF, "byte order mark", "delete it"},
    NamedCharacter{0xFF08, "fullwidth left parenthesis", "write '('"},
    NamedCharacter{0xFF09, "fullwidth right parenthesis", "write ')'"},
    NamedCharacter{0xFF0C, "fullwidth comma", "write ','"},
    NamedCharacter{0x03C0, "Greek letter pi", "write 'pi'"},
};

// From U+03B1 on, with the final sigma.
constexpr std::array<std::string_view, 25> greek_letters{
    "alpha", "beta",    "gamma", "delta", "epsilon", "zeta",  "eta", "theta",   "iota", "kappa", "lambda", "mu",   "nu",
    "xi",    "omicron", "pi",    "rho",   "sigma",   "sigma", "tau", "upsilon", "phi",  "chi",   "psi",    "omega"};

std::string name_of(char32_t code) {
  for (const auto& known : named_characters) {
    if (known.code == code) return std::string(known.name);
  }
  if (code >= 0x03B1 && code <= 0x03C9) return fmt::format("Greek letter {}", greek_letters[code - 0x03B1]);
  if (code >= 0x0391 && code <= 0x03A9) return fmt::format("Greek capital letter {}", greek_letters[code - 0x0391]);
  return code == 0x00B5 ? "micro sign" : "";
}

std::string remedy_for(char32_t code) {
  for (const auto& known : named_characters) {
    if (known.code == code) return std::string(known.remedy);
  }
  if (code == 0x00B5) return "names consist of the letters a-z, A-Z, digits and '_': write 'mu'";
  if (code >= 0x03B1 && code <= 0x03C9) {
    return fmt::format("names consist of the letters a-z, A-Z, digits and '_': write '{}'",
                       greek_letters[code - 0x03B1]);
  }
  return "expressions consist of ASCII characters; names of the letters a-z, A-Z, digits and '_'";
}

struct CodePoint {
  char32_t code;
  std::size_t bytes;
};

/// First code point of a UTF-8 text; nullopt if it does not begin with one.
std::optional<CodePoint> decode(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<std::uint32_t>(static_cast<unsigned char>(text[i])); };
  const std::uint32_t lead = byte(0);
  if (lead < 0x80) return CodePoint{lead, 1};
  const std::size_t bytes = (lead & 0xE0U) == 0xC0U ? 2 : (lead & 0xF0U) == 0xE0U ? 3 : (lead & 0xF8U) == 0xF0U ? 4 : 0;
  if (bytes == 0 || text.size() < bytes) return std::nullopt;
  std::uint32_t code = lead & (0xFFU >> (bytes + 1));
  for (std::size_t i = 1; i < bytes; ++i) {
    if ((byte(i) & 0xC0U) != 0x80U) return std::nullopt;
    code = (code << 6U) | (byte(i) & 0x3FU);
  }
  constexpr std::array<std::uint32_t, 5> smallest{0, 0, 0x80, 0x800, 0x10000};
  const bool surrogate = code >= 0xD800 && code <= 0xDFFF;
  if (code < smallest[bytes] || code > 0x10FFFF || surrogate) return std::nullopt;
  return CodePoint{code, bytes};
}

struct FunctionMistake {
  std::string_view name;
  std::string_view remedy;
};

constexpr std::string_view contact_output =
    "results have gap(NAME), force(NAME), friction(NAME) and impulse(NAME) of contacts by themselves; in an expression "
    "write what the gap is";

constexpr std::string_view no_delay =
    "delays are not there: states in a row come close, z1' = n*(u - z1)/T, z2' = n*(z1 - z2)/T, … up to zn";
constexpr std::string_view no_chance =
    "nothing in a run is random: samples of parameters are for a sweep (--sample), noise is data by times, "
    "inputs = { w = { file = \"w.csv\" } }";

constexpr std::string_view dead_zone = "write x - min(max(x, -w), w), of half width w";
constexpr std::string_view two_thresholds =
    "write sign(x), or with two thresholds [[hysteresis]], whose name is then 0 or 1";
constexpr std::string_view by_table = "write [tables.road] with x = [0, 1] and y = [0, 2], then road(x)";
constexpr std::string_view all_terms =
    "write the terms: x1 + x2 + x3; arrays are in saltus.Builder of the Python package";

constexpr std::array function_mistakes{
    FunctionMistake{"deadzone", dead_zone},
    FunctionMistake{"dead_zone", dead_zone},
    FunctionMistake{"deadband", dead_zone},
    FunctionMistake{"relay", two_thresholds},
    FunctionMistake{"hysteresis", two_thresholds},
    FunctionMistake{"hill", "write x^n/(K^n + x^n)"},
    FunctionMistake{"sigmoid", "write 1/(1 + exp(-x))"},
    FunctionMistake{"logistic", "write 1/(1 + exp(-x))"},
    FunctionMistake{"ramp", "write max(t - t0, 0)"},
    FunctionMistake{"pulse", "write step(t - t0) - step(t - t1)"},
    FunctionMistake{"square_wave", "write sign(mod(t, T) - T/2)"},
    FunctionMistake{"sawtooth", "write mod(t, T)/T"},
    FunctionMistake{"linspace",
                    "values at times are inputs = { u = { times = [0, 1], values = [2, 3] } } of [simulate]"},
    FunctionMistake{"interp", by_table},
    FunctionMistake{"interp1", by_table},
    FunctionMistake{"lookup", by_table},
    FunctionMistake{"table", by_table},
    FunctionMistake{"spline", by_table},
    FunctionMistake{"sum", all_terms},
    FunctionMistake{"mean", all_terms},
    FunctionMistake{"norm", "write sqrt(x^2 + y^2)"},
    FunctionMistake{"integral", "add a state z under [states], with z = \"what is integrated\" under [dynamics]"},
    FunctionMistake{"delay", no_delay},
    FunctionMistake{"rand", no_chance},
    FunctionMistake{"randn", no_chance},
    FunctionMistake{"random", no_chance},
    FunctionMistake{"normal", no_chance},
    FunctionMistake{"uniform", no_chance},
    FunctionMistake{"sgn", "did you mean 'sign'?"},
    FunctionMistake{"signum", "did you mean 'sign'?"},
    FunctionMistake{"heaviside", "did you mean 'step'?"},
    FunctionMistake{"Heaviside", "did you mean 'step'?"},
    FunctionMistake{"unitstep", "did you mean 'step'?"},
    FunctionMistake{"unit_step", "did you mean 'step'?"},
    FunctionMistake{"ln", "did you mean 'log' (the natural logarithm)?"},
    FunctionMistake{"lg", "did you mean 'log10'?"},
    FunctionMistake{"log2", "write log(x)/log(2)"},
    FunctionMistake{"log1p", "write log(1 + x)"},
    FunctionMistake{"expm1", "write exp(x) - 1"},
    FunctionMistake{"fabs", "did you mean 'abs'?"},
    FunctionMistake{"absolute", "did you mean 'abs'?"},
    FunctionMistake{"arcsin", "did you mean 'asin'?"},
    FunctionMistake{"arccos", "did you mean 'acos'?"},
    FunctionMistake{"arctan", "did you mean 'atan'?"},
    FunctionMistake{"arctan2", "did you mean 'atan2'?"},
    FunctionMistake{"arctg", "did you mean 'atan'?"},
    FunctionMistake{"tg", "did you mean 'tan'?"},
    FunctionMistake{"sh", "did you mean 'sinh'?"},
    FunctionMistake{"ch", "did you mean 'cosh'?"},
    FunctionMistake{"th", "did you mean 'tanh'?"},
    FunctionMistake{"cot", "write 1/tan(x)"},
    FunctionMistake{"sec", "write 1/cos(x)"},
    FunctionMistake{"csc", "write 1/sin(x)"},
    FunctionMistake{"asinh", "write log(x + sqrt(x^2 + 1))"},
    FunctionMistake{"arcsinh", "write log(x + sqrt(x^2 + 1))"},
    FunctionMistake{"acosh", "write log(x + sqrt(x^2 - 1))"},
    FunctionMistake{"arccosh", "write log(x + sqrt(x^2 - 1))"},
    FunctionMistake{"atanh", "write log((1 + x)/(1 - x))/2"},
    FunctionMistake{"arctanh", "write log((1 + x)/(1 - x))/2"},
    FunctionMistake{"sqr", "write x^2"},
    FunctionMistake{"square", "write x^2"},
    FunctionMistake{"cbrt", "write sign(x)*abs(x)^(1/3)"},
    FunctionMistake{"power", "did you mean 'pow'?"},
    FunctionMistake{"ceil", "write -floor(-x)"},
    FunctionMistake{"round", "write floor(x + 0.5)"},
    FunctionMistake{"quantize", "in `set` of a jump write q*floor(x/q)"},
    FunctionMistake{"int", "did you mean 'floor'?"},
    FunctionMistake{"trunc", "did you mean 'floor'?"},
    FunctionMistake{"fmod", "did you mean 'mod'?"},
    FunctionMistake{"rem", "did you mean 'mod'?"},
    FunctionMistake{"modulo", "did you mean 'mod'?"},
    FunctionMistake{"fmax", "did you mean 'max'?"},
    FunctionMistake{"fmin", "did you mean 'min'?"},
    FunctionMistake{"maximum", "did you mean 'max'?"},
    FunctionMistake{"minimum", "did you mean 'min'?"},
    FunctionMistake{"ifelse", "write if(condition, a, b)"},
    FunctionMistake{"if_else", "write if(condition, a, b)"},
    FunctionMistake{"ite", "write if(condition, a, b)"},
    FunctionMistake{"where", "write if(condition, a, b)"},
    FunctionMistake{"piecewise", "write if(condition, a, b), nested for more pieces"},
    FunctionMistake{"sat", "write min(max(x, lower), upper)"},
    FunctionMistake{"saturate", "write min(max(x, lower), upper)"},
    FunctionMistake{"saturation", "write min(max(x, lower), upper)"},
    FunctionMistake{"clip", "write min(max(x, lower), upper)"},
    FunctionMistake{"clamp", "write min(max(x, lower), upper)"},
    FunctionMistake{"AND", "write 'and' between two conditions"},
    FunctionMistake{"OR", "write 'or' between two conditions"},
    FunctionMistake{"NOT", "write 'not' in lower case"},
    FunctionMistake{"gap", contact_output},
    FunctionMistake{"force", contact_output},
    FunctionMistake{"friction", contact_output},
    FunctionMistake{"impulse", contact_output},
};

}  // namespace

std::string quoted(std::string_view text) {
  constexpr std::size_t longest = 40;  // a message stays one line
  if (text.size() <= longest) return fmt::format("'{}'", text);
  return fmt::format("'{}…'", text.substr(0, longest));
}

const SymbolMistake* long_symbol_mistake(std::string_view rest) { return first_match(long_mistakes, rest); }

const SymbolMistake* short_symbol_mistake(std::string_view rest) { return first_match(short_mistakes, rest); }

ForeignCharacter foreign_character(std::string_view rest) {
  const auto character = decode(rest);
  if (!character) {
    return {rest.substr(0, 1), fmt::format("byte 0x{:02X}, which is not UTF-8", static_cast<unsigned char>(rest[0])),
            "save the file as UTF-8; expressions consist of ASCII characters"};
  }
  const auto text = rest.substr(0, character->bytes);
  const auto code = static_cast<std::uint32_t>(character->code);
  if (code < 0x20 || (code >= 0x7F && code < 0xA0)) {
    return {text, fmt::format("control character U+{:04X}", code), "delete it"};
  }
  if (code < 0x80) return {text, quoted(text), "no expression contains it"};
  const auto name = name_of(character->code);
  return {text, fmt::format("'{}' (U+{:04X}{}{})", text, code, name.empty() ? "" : ", ", name),
          remedy_for(character->code)};
}

std::string_view remedy_for_function(std::string_view name) {
  const auto found = std::find_if(function_mistakes.begin(), function_mistakes.end(),
                                  [&](const FunctionMistake& mistake) { return mistake.name == name; });
  return found == function_mistakes.end() ? std::string_view{} : found->remedy;
}

}  // namespace saltus::expression
