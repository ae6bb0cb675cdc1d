#include "saltus/expression/latex.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>

#include <fmt/format.h>

#include "saltus/base/contains.hpp"
#include "saltus/expression/grammar_internal.hpp"
#include "saltus/expression/parser.hpp"

namespace saltus::expression {
namespace {

constexpr std::array<std::string_view, 34> letters_of_latex = {
    "alpha", "beta", "gamma",  "delta", "epsilon", "zeta", "eta", "theta", "iota",    "kappa",  "lambda", "mu",
    "nu",    "xi",   "pi",     "rho",   "sigma",   "tau",  "phi", "chi",   "psi",     "omega",  "Gamma",  "Delta",
    "Theta", "Xi",   "Lambda", "Pi",    "Sigma",   "Phi",  "Psi", "Omega", "upsilon", "Upsilon"};
constexpr std::array<std::string_view, 14> commands = {"sin", "cos", "tan", "sinh", "cosh", "tanh", "exp",
                                                       "log", "max", "min", "arg",  "det",  "gcd",  "lim"};

std::string letters_of(std::string_view word) {
  if (contains(letters_of_latex, word)) return fmt::format("\\{}", word);
  return word.size() == 1 ? std::string(word) : fmt::format("\\mathrm{{{}}}", latex_escaped(word));
}

/// How tightly a node holds together once it is written: fractions and powers of LaTeX need fewer parentheses.
Precedence written_precedence(const Node& node) {
  if (const auto* binary = std::get_if<Binary>(&node.value)) {
    return binary->op == BinaryOperator::divide ? Precedence::product : grammar_of(binary->op).precedence;
  }
  if (const auto* unary = std::get_if<Unary>(&node.value)) {
    return unary->op == UnaryOperator::logical_not ? Precedence::logical_not : Precedence::sign;
  }
  return Precedence::primary;
}

std::string within(const Node& node, Precedence loosest) {
  const auto text = to_latex(node);
  return written_precedence(node) < loosest ? fmt::format("\\left({}\\right)", text) : text;
}

std::string_view sign_of(BinaryOperator op) {
  switch (op) {
    case BinaryOperator::less_equal:
      return "\\le";
    case BinaryOperator::greater_equal:
      return "\\ge";
    case BinaryOperator::equal:
      return "=";
    case BinaryOperator::not_equal:
      return "\\ne";
    case BinaryOperator::logical_and:
      return "\\wedge";
    case BinaryOperator::logical_or:
      return "\\vee";
    case BinaryOperator::multiply:
      return "\\,";
    default:
      return grammar_of(op).text;
  }
}

/// A number behind a product sign would join the number before it.
bool begins_with_digit(const std::string& text) {
  return !text.empty() && std::isdigit(static_cast<unsigned char>(text.front())) != 0;
}

std::string latex_of(const Number& number) {
  const auto text = number.spelling.empty() ? fmt::format("{}", number.value) : number.spelling;
  const auto exponent = text.find_first_of("eE");
  if (exponent == std::string::npos) return text;
  const auto mantissa = text.substr(0, exponent);
  auto power = text.substr(exponent + 1);
  if (!power.empty() && power.front() == '+') power.erase(0, 1);
  return fmt::format("{} \\cdot 10^{{{}}}", mantissa, power);
}

std::string latex_of(const Name& name) { return latex_name(name.name); }

std::string latex_of(const Unary& unary) {
  if (unary.op == UnaryOperator::logical_not) return "\\neg " + within(*unary.operand, Precedence::comparison);
  return (unary.op == UnaryOperator::minus ? "-" : "+") + within(*unary.operand, Precedence::product);
}

std::string latex_of(const Binary& binary) {
  if (binary.op == BinaryOperator::divide) {
    return fmt::format("\\frac{{{}}}{{{}}}", to_latex(*binary.left), to_latex(*binary.right));
  }
  if (binary.op == BinaryOperator::power) {
    return fmt::format("{{{}}}^{{{}}}", within(*binary.left, Precedence::primary), to_latex(*binary.right));
  }
  const auto& grammar = grammar_of(binary.op);
  const auto left = within(*binary.left, left_operand(grammar));
  const auto right = within(*binary.right, right_operand(grammar));
  const bool are_numbers = binary.op == BinaryOperator::multiply && begins_with_digit(right);
  return fmt::format("{} {} {}", left, are_numbers ? "\\cdot" : sign_of(binary.op), right);
}

std::string latex_of(const Call& call) {
  const auto& arguments = call.arguments;
  const auto is = [&](std::string_view name, std::size_t count) {
    return call.function == name && arguments.size() == count;
  };
  if (is("if", 3)) {
    return fmt::format("\\begin{{cases}} {} & {} \\\\ {} & \\text{{else}} \\end{{cases}}", to_latex(*arguments[1]),
                       to_latex(*arguments[0]), to_latex(*arguments[2]));
  }
  if (is("sqrt", 1)) return fmt::format("\\sqrt{{{}}}", to_latex(*arguments[0]));
  if (is("abs", 1)) return fmt::format("\\left|{}\\right|", to_latex(*arguments[0]));
  if (is("floor", 1)) return fmt::format("\\left\\lfloor {} \\right\\rfloor", to_latex(*arguments[0]));
  std::string list;
  for (const auto& argument : arguments) list += (list.empty() ? "" : ", ") + to_latex(*argument);
  const auto name = contains(commands, call.function)
                        ? "\\" + call.function
                        : fmt::format("\\operatorname{{{}}}", latex_escaped(call.function));
  return fmt::format("{}\\left({}\\right)", name, list);
}

}  // namespace

std::string latex_escaped(std::string_view text) {
  std::string result;
  for (const char c : text) result += c == '_' ? std::string("\\_") : std::string(1, c);
  return result;
}

std::string latex_name(const std::string& name) {
  const auto underscore = name.find('_', 1);
  auto letters = name.substr(0, underscore);
  std::string index = underscore == std::string::npos ? "" : name.substr(underscore + 1);
  const auto is_digit = [](char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; };
  const auto last = std::find_if_not(letters.rbegin(), letters.rend(), is_digit).base();
  if (last != letters.begin() && last != letters.end()) {
    const std::string digits(last, letters.end());
    letters.erase(last, letters.end());
    index = index.empty() ? digits : digits + "," + index;
  }
  if (index.empty()) return letters_of(letters);
  const bool is_word = std::any_of(index.begin(), index.end(), [](unsigned char c) { return std::isalpha(c) != 0; });
  return fmt::format(
      "{}_{{{}}}", letters_of(letters),
      is_word && index.size() > 1 ? fmt::format("\\mathrm{{{}}}", latex_escaped(index)) : latex_escaped(index));
}

std::string to_latex(const Node& node) {
  return std::visit([](const auto& value) { return latex_of(value); }, node.value);
}

}  // namespace saltus::expression
