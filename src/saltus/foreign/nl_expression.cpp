#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "saltus/base/at.hpp"
#include "saltus/foreign/nl_expression_internal.hpp"

namespace saltus::foreign {
namespace {

using casadi::SX;

constexpr long no_limit = 1L << 40;

/// An operator that still waits for operands.
struct Waiting {
  const NlOperator* operation = nullptr;
  std::size_t operands = 0;
  std::vector<SX> found;
};

double finite_constant(NlLines& lines) {
  const char letter = lines.letter();
  if (letter != 'n' && letter != 's' && letter != 'l') {
    lines.fail(fmt::format("expected a constant (n, s or l and a number), found '{}'", lines.word(0)));
  }
  const double value = lines.number_behind_letter("a constant");
  if (!std::isfinite(value)) lines.fail("an infinite constant in an expression");
  return value;
}

SX reference(NlLines& lines, const NlNames& names) {
  const auto variables = static_cast<long>(names.variables.size());
  const long i = lines.whole_behind_letter("the number of a variable", 0, no_limit);
  if (lines.failed()) return 0.0;
  if (i < variables) return names.variables[at(i)];
  const auto found = names.defined.find(i);
  if (found != names.defined.end()) return found->second;
  lines.fail(fmt::format("v{} is neither one of the {} variables nor defined by a segment V above", i, variables),
             "common expressions are numbered behind the variables and defined before they are used");
  return 0.0;
}

SX piecewise_linear_term(NlLines& lines, const NlNames& names) {
  if (!lines.advance("the number of slopes of a piecewise linear term")) return 0.0;
  const long pieces = lines.whole(0, "the number of slopes of a piecewise linear term", 2, lines.lines_left());
  std::vector<double> slopes, breakpoints;
  for (long i = 0; i < 2 * pieces - 1 && !lines.failed(); ++i) {
    if (!lines.advance("a slope or breakpoint of a piecewise linear term")) return 0.0;
    (i % 2 == 0 ? slopes : breakpoints).push_back(finite_constant(lines));
    if (i % 2 == 1 && breakpoints.size() > 1 && breakpoints.back() < breakpoints[breakpoints.size() - 2]) {
      lines.fail(fmt::format("breakpoint {} follows a larger one", breakpoints.back()));
    }
  }
  if (!lines.advance("the variable of a piecewise linear term")) return 0.0;
  if (lines.letter() != 'v') {
    lines.fail(
        fmt::format("expected the variable of a piecewise linear term, v and a number, found '{}'", lines.word(0)));
  }
  const SX x = reference(lines, names);
  return lines.failed() ? SX(0.0) : piecewise_linear(slopes, breakpoints, x);
}

constexpr long piecewise_linear_code = 64;

/// Begins the operator of this line.
std::optional<Waiting> begin_operator(NlLines& lines) {
  const long code = lines.whole_behind_letter("the code of an operator", 0, no_limit);
  const auto* operation = lines.failed() ? nullptr : nl_operator(code);
  if (operation == nullptr) {
    const bool is_text = code == 61 || code == 65 || code == 79;  // numberof and if of texts, function calls
    lines.fail(is_text ? fmt::format("operator o{} works on texts, which is not available", code)
                       : fmt::format("there is no operator o{}", code),
               is_text ? "state the model without symbolic values" : "the codes are those of AMPL's .nl format",
               is_text ? ErrorCode::not_available : ErrorCode::parse_failure);
    return std::nullopt;
  }
  if (operation->operands >= 0) return Waiting{operation, at(operation->operands), {}};
  const auto what = fmt::format("the number of operands of o{}", code);
  if (!lines.advance(what)) return std::nullopt;
  const long count = lines.whole(0, what, operation->fewest, std::max(lines.lines_left(), long{operation->fewest}));
  constexpr long most_compared = 1000;  // pairs of operands grow with the square
  if ((code == 74 || code == 75) && count > most_compared) {
    lines.fail(fmt::format("alldiff of {} operands", count), "at most 1000 can be compared with each other");
  }
  return Waiting{operation, at(count), {}};
}

void refuse_operand(NlLines& lines) {
  if (lines.letter() == 'f') {
    lines.fail(fmt::format("'{}' calls a function of a library of the user's", lines.word(0)),
               "write the function with the operations of the language (functions of libraries are not available)",
               ErrorCode::not_available);
  } else if (lines.letter() == 'h') {
    lines.fail("a text in an expression", "state the model without symbolic values", ErrorCode::not_available);
  } else {
    lines.fail(fmt::format("expected an expression (o, n, v and a number), found '{}'", lines.word(0)));
  }
}

}  // namespace

SX read_expression(NlLines& lines, const NlNames& names) {
  std::vector<Waiting> open;
  while (lines.advance("an expression")) {
    SX value = 0.0;
    const char letter = lines.letter();
    if (letter == 'o' && lines.word(0) != fmt::format("o{}", piecewise_linear_code)) {
      auto waiting = begin_operator(lines);
      if (!waiting || lines.failed()) break;
      open.push_back(std::move(*waiting));
      continue;
    }
    if (letter == 'o') {
      value = piecewise_linear_term(lines, names);
    } else if (letter == 'v') {
      value = reference(lines, names);
    } else if (letter == 'n' || letter == 's' || letter == 'l') {
      value = finite_constant(lines);
    } else {
      refuse_operand(lines);
    }
    if (lines.failed()) break;
    while (!open.empty()) {
      auto& last = open.back();
      last.found.push_back(value);
      if (last.found.size() < last.operands) break;
      value = last.operation->make(last.found);
      open.pop_back();
    }
    if (open.empty()) return value;
  }
  return 0.0;
}

}  // namespace saltus::foreign
