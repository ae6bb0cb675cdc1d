#include <array>
#include <cmath>
#include <numbers>
#include <string_view>

#include "saltus/io/constant_value_internal.hpp"

namespace saltus::io {
namespace {

using expression::BinaryOperator;
using expression::UnaryOperator;

struct Function1 {
  std::string_view name;
  double (*value)(double);
};
constexpr std::array functions1{
    Function1{"sin", std::sin},   Function1{"cos", std::cos},   Function1{"tan", std::tan},
    Function1{"asin", std::asin}, Function1{"acos", std::acos}, Function1{"atan", std::atan},
    Function1{"sinh", std::sinh}, Function1{"cosh", std::cosh}, Function1{"tanh", std::tanh},
    Function1{"exp", std::exp},   Function1{"log", std::log},   Function1{"log10", std::log10},
    Function1{"sqrt", std::sqrt}, Function1{"abs", std::fabs},  Function1{"floor", std::floor},
};

double floored_remainder(double e, double m) { return e - m * std::floor(e / m); }

struct Function2 {
  std::string_view name;
  double (*value)(double, double);
};
constexpr std::array functions2{
    Function2{"atan2", std::atan2}, Function2{"hypot", std::hypot}, Function2{"pow", std::pow},
    Function2{"max", std::fmax},    Function2{"min", std::fmin},    Function2{"mod", floored_remainder},
};

struct Evaluate {
  using Value = std::optional<double>;

  Value operator()(const expression::Number& number) const { return number.value; }
  Value operator()(const expression::Name& name) const {
    return name.name == "pi" ? Value(std::numbers::pi) : std::nullopt;
  }
  Value operator()(const expression::Unary& unary) const {
    const auto operand = constant_value(*unary.operand);
    if (!operand || unary.op == UnaryOperator::logical_not) return std::nullopt;
    return unary.op == UnaryOperator::minus ? -*operand : *operand;
  }
  Value operator()(const expression::Binary& binary) const {
    const auto left = constant_value(*binary.left);
    const auto right = constant_value(*binary.right);
    if (!left || !right) return std::nullopt;
    if (binary.op == BinaryOperator::add) return *left + *right;
    if (binary.op == BinaryOperator::subtract) return *left - *right;
    if (binary.op == BinaryOperator::multiply) return *left * *right;
    if (binary.op == BinaryOperator::divide) return *left / *right;
    if (binary.op == BinaryOperator::power) return std::pow(*left, *right);
    return std::nullopt;
  }
  Value operator()(const expression::Call& call) const {
    if (call.arguments.empty()) return std::nullopt;
    const auto first = constant_value(*call.arguments.front());
    const auto last = constant_value(*call.arguments.back());
    if (!first || !last) return std::nullopt;
    for (const auto& function : functions1) {
      if (function.name == call.function) return function.value(*first);
    }
    for (const auto& function : functions2) {
      if (function.name == call.function) return function.value(*first, *last);
    }
    return std::nullopt;
  }
};

}  // namespace

std::optional<double> constant_value(const expression::Node& node) { return std::visit(Evaluate{}, node.value); }

}  // namespace saltus::io
