#include <array>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "saltus/expression/parser.hpp"
#include "saltus/model/statement/model_scope_internal.hpp"
#include "saltus/model/statement/statement_internal.hpp"
#include "saltus/model/statement/translation_internal.hpp"

namespace saltus::model {
namespace {

using expression::BinaryOperator;
using expression::Node;
using expression::NodePtr;
using expression::UnaryOperator;

struct SmoothFunction {
  std::string_view name;
  int operation;
  int arguments;
};

constexpr std::array smooth_functions{
    SmoothFunction{"sin", casadi::OP_SIN, 1},     SmoothFunction{"cos", casadi::OP_COS, 1},
    SmoothFunction{"tan", casadi::OP_TAN, 1},     SmoothFunction{"asin", casadi::OP_ASIN, 1},
    SmoothFunction{"acos", casadi::OP_ACOS, 1},   SmoothFunction{"atan", casadi::OP_ATAN, 1},
    SmoothFunction{"sinh", casadi::OP_SINH, 1},   SmoothFunction{"cosh", casadi::OP_COSH, 1},
    SmoothFunction{"tanh", casadi::OP_TANH, 1},   SmoothFunction{"exp", casadi::OP_EXP, 1},
    SmoothFunction{"log", casadi::OP_LOG, 1},     SmoothFunction{"sqrt", casadi::OP_SQRT, 1},
    SmoothFunction{"atan2", casadi::OP_ATAN2, 2}, SmoothFunction{"hypot", casadi::OP_HYPOT, 2},
    SmoothFunction{"pow", casadi::OP_POW, 2},
};

bool is_comparison(BinaryOperator op) {
  switch (op) {
    case BinaryOperator::less:
    case BinaryOperator::less_equal:
    case BinaryOperator::greater:
    case BinaryOperator::greater_equal:
    case BinaryOperator::equal:
    case BinaryOperator::not_equal:
      return true;
    case BinaryOperator::add:
    case BinaryOperator::subtract:
    case BinaryOperator::multiply:
    case BinaryOperator::divide:
    case BinaryOperator::power:
    case BinaryOperator::logical_and:
    case BinaryOperator::logical_or:
      return false;
  }
  return false;
}

bool is_logical(BinaryOperator op) { return op == BinaryOperator::logical_and || op == BinaryOperator::logical_or; }

bool is_zero(const Node& node) {
  const auto* number = std::get_if<expression::Number>(&node.value);
  return number != nullptr && number->value == 0.0;
}

/// Of a comparison with 0 or a choice between 0 and something: the other side. Null without a 0.
const Node* beside_zero(const NodePtr& a, const NodePtr& b) {
  if (is_zero(*a) == is_zero(*b)) return nullptr;
  return is_zero(*a) ? b.get() : a.get();
}

/// The text of an expression without parentheses around all of it.
std::string bare_text(Node node) {
  node.parenthesised = false;
  return expression::to_text(node);
}

std::string call_text(const expression::Call& call) {
  Node node;
  node.value = call;
  return expression::to_text(node);
}

Error condition_found(const Node& node) {
  return {ErrorCode::invalid_model,
          fmt::format("expected a number, found the condition '{}'", expression::to_text(node)),
          "use if(condition, a, b), e.g. if(condition, 1, 0)",
          node.location,
          {}};
}

/// A problem has replaced what it may say (optimal_control/initial_values).
Error initial_elsewhere(const expression::Call& call, const SourceLocation& location) {
  return {ErrorCode::invalid_model,
          fmt::format("'{}' may stand in terminal_constraints and terminal_cost of [optimize] only", call_text(call)),
          "write the number or the parameter that is the initial value in [states]",
          location,
          {}};
}

int casadi_operation(BinaryOperator op) {
  switch (op) {
    case BinaryOperator::add:
      return casadi::OP_ADD;
    case BinaryOperator::subtract:
      return casadi::OP_SUB;
    case BinaryOperator::multiply:
      return casadi::OP_MUL;
    case BinaryOperator::divide:
      return casadi::OP_DIV;
    default:
      return casadi::OP_POW;
  }
}

SXElem log10_of(const SXElem& x) {
  if (x.is_constant()) return SXElem(std::log10(static_cast<double>(x)));
  return SXElem::unary(casadi::OP_LOG, x) / std::numbers::ln10;
}

}  // namespace

bool Translation::is_condition(const Node& node) const {
  if (const auto* name = std::get_if<expression::Name>(&node.value)) return scope_.is_condition(name->name);
  if (const auto* unary = std::get_if<expression::Unary>(&node.value)) return unary->op == UnaryOperator::logical_not;
  const auto* binary = std::get_if<expression::Binary>(&node.value);
  return binary != nullptr && (is_comparison(binary->op) || is_logical(binary->op));
}

Expected<SXElem> Translation::number(const Node& node) {
  if (is_condition(node)) return tl::unexpected(condition_found(node));
  if (const auto* number = std::get_if<expression::Number>(&node.value)) return SXElem(number->value);
  if (const auto* name = std::get_if<expression::Name>(&node.value)) {
    if (name->name == "pi") return SXElem(std::numbers::pi);
    return scope_.number(name->name, node.location);
  }
  if (const auto* unary_node = std::get_if<expression::Unary>(&node.value)) return unary(*unary_node, node.location);
  if (const auto* binary_node = std::get_if<expression::Binary>(&node.value))
    return binary(*binary_node, node.location);
  return call(std::get<expression::Call>(node.value), node.location);
}

Expected<SXElem> Translation::unary(const expression::Unary& unary, const SourceLocation&) {
  auto operand = number(*unary.operand);
  if (!operand || unary.op != UnaryOperator::minus) return operand;
  return -*operand;
}

Expected<SXElem> Translation::binary(const expression::Binary& binary, const SourceLocation&) {
  const auto left = number(*binary.left);
  if (!left) return left;
  const auto right = number(*binary.right);
  if (!right) return right;
  return SXElem::binary(casadi_operation(binary.op), *left, *right);
}

Expected<SXElem> Translation::call(const expression::Call& call, const SourceLocation& location) {
  if (call.function == "initial") return tl::unexpected(initial_elsewhere(call, location));
  if (call.function == "if")
    return branch(call).map_error([&](Error e) { return with_location(std::move(e), location); });
  const auto first = number(*call.arguments.front());
  if (!first) return first;
  if (call.function == "log10") return log10_of(*first);
  for (const auto& [name, operation, arguments] : smooth_functions) {
    if (call.function != name) continue;
    if (arguments == 1) return SXElem::unary(operation, *first);
    const auto second = number(*call.arguments.back());
    return second ? Expected<SXElem>(SXElem::binary(operation, *first, *second)) : second;
  }
  return nonsmooth(call, location);
}

Expected<SXElem> Translation::nonsmooth(const expression::Call& call, const SourceLocation& location) {
  const auto locate = [&](Error error) { return with_location(std::move(error), location); };
  const auto a = number(*call.arguments.front());
  if (!a) return a;
  const std::string text = expression::to_text(*call.arguments.front());
  if (call.function == "step") return recognition_.step(*a, text).map_error(locate);
  if (call.function == "sign") return recognition_.sign(*a, text).map_error(locate);
  if (call.function == "abs") return recognition_.abs(*a, text).map_error(locate);
  if (call.arguments.size() == 1) return cells(call, *a).map_error(locate);
  const auto b = number(*call.arguments.back());
  if (!b) return b;
  if (call.function == "mod") return recognition_.mod(*a, *b, call_text(call)).map_error(locate);
  const auto& first = call.arguments.front();
  const auto& last = call.arguments.back();
  const Node* other = beside_zero(first, last);
  if (other != nullptr && is_zero(*first)) {  // max(0, e) is max(e, 0), and switches where e does
    return (call.function == "max" ? recognition_.max(*b, *a, bare_text(*other))
                                   : recognition_.min(*b, *a, bare_text(*other)))
        .map_error(locate);
  }
  const std::string difference = other != nullptr ? bare_text(*other) : expression::difference_text(first, last);
  return (call.function == "max" ? recognition_.max(*a, *b, difference) : recognition_.min(*a, *b, difference))
      .map_error(locate);
}

/// floor, or a table of the model: the parser knows no other functions.
Expected<SXElem> Translation::cells(const expression::Call& call, const SXElem& argument) {
  const std::string text = call_text(call);
  if (call.function == "floor") return recognition_.floor(argument, text);
  auto table = scope_.table(call.function);
  if (!table) return tl::unexpected(table.error());
  return recognition_.lookup(*table, argument, text);
}

Expected<SXElem> Translation::branch(const expression::Call& call) {
  const auto holds = condition(*call.arguments[0]);
  if (!holds) return tl::unexpected(holds.error());
  const auto a = number(*call.arguments[1]);
  if (!a) return a;
  const auto b = number(*call.arguments[2]);
  if (!b) return b;
  return recognition_.select(*holds, *a, *b);
}

Expected<Condition> Translation::condition(const Node& node) {
  const auto* word = std::get_if<expression::Name>(&node.value);
  if (word != nullptr && word->name == "otherwise") {
    return tl::unexpected(Error{ErrorCode::invalid_model,
                                "'otherwise' is no condition: it stands alone as the `when` of a mode",
                                "write when = \"otherwise\", or the condition itself",
                                node.location,
                                {}});
  }
  if (word != nullptr && scope_.is_given_up(word->name)) {
    return tl::unexpected(Error{ErrorCode::invalid_model, "", "", node.location, {}});
  }
  if (!is_condition(node)) {
    return tl::unexpected(Error{ErrorCode::invalid_model,
                                fmt::format("expected a condition, found the number '{}'", expression::to_text(node)),
                                fmt::format("compare it with something, e.g. {} > 0", expression::to_text(node)),
                                node.location,
                                {}});
  }
  if (const auto* name = std::get_if<expression::Name>(&node.value)) return scope_.condition(name->name, node.location);
  if (const auto* negated = std::get_if<expression::Unary>(&node.value)) {
    return condition(*negated->operand).map([](const Condition& a) { return !a; });
  }
  const auto& joined = std::get<expression::Binary>(node.value);
  if (is_comparison(joined.op)) return comparison(joined, node.location);
  const auto a = condition(*joined.left);
  if (!a) return a;
  const auto b = condition(*joined.right);
  if (!b) return b;
  return joined.op == BinaryOperator::logical_and ? *a && *b : *a || *b;
}

Expected<Condition> Translation::comparison(const expression::Binary& binary, const SourceLocation& location) {
  if (binary.op == BinaryOperator::equal || binary.op == BinaryOperator::not_equal) return equality(binary, location);
  const auto left = number(*binary.left);
  if (!left) return tl::unexpected(left.error());
  const auto right = number(*binary.right);
  if (!right) return tl::unexpected(right.error());
  const bool is_less = binary.op == BinaryOperator::less || binary.op == BinaryOperator::less_equal;
  const bool inclusive = binary.op == BinaryOperator::less_equal || binary.op == BinaryOperator::greater_equal;
  if (const Node* other = beside_zero(binary.left, binary.right)) {
    // The function is the other side as it is: e < 0 holds where e >= 0 does not.
    const bool above = is_zero(*binary.left) == is_less;
    const casadi::SX e(is_zero(*binary.left) ? *right : *left);
    const auto at_zero = inclusive == above ? AtEquality::is_true : AtEquality::is_false;
    const Condition positive(Comparison{e, at_zero, bare_text(*other), Sides::any});
    return above ? positive : !positive;
  }
  return Condition(Comparison{casadi::SX(is_less ? *right - *left : *left - *right),
                              inclusive ? AtEquality::is_true : AtEquality::is_false,
                              is_less ? expression::difference_text(binary.right, binary.left)
                                      : expression::difference_text(binary.left, binary.right),
                              Sides::any});
}

Expected<Condition> Translation::equality(const expression::Binary& binary, const SourceLocation& location) {
  const auto left = number(*binary.left);
  if (!left) return tl::unexpected(left.error());
  const auto right = number(*binary.right);
  if (!right) return tl::unexpected(right.error());
  for (const auto& [side, node] : {std::pair{*left, binary.left}, std::pair{*right, binary.right}}) {
    const auto still = recognition_.changes_by_jumps_only(side);
    if (!still) return tl::unexpected(with_location(still.error(), location));
    if (*still) continue;
    return tl::unexpected(Error{
        ErrorCode::invalid_model,
        fmt::format("== and != compare constants, parameters and discrete states only, and '{}' moves: it is equal "
                    "to something for an instant at most",
                    expression::to_text(*node)),
        "use <, <=, > or >=, or an interval such as abs(x - a) < 1e-3; a discrete state has dynamics 0",
        location,
        {}});
  }
  const auto a = recognition_.parameter_value(*left), b = recognition_.parameter_value(*right);
  const bool asked_equal = binary.op == BinaryOperator::equal;
  if (a && b) {
    const casadi::SX difference(*left - *right);
    if (const auto node = recognition_.graph.add(difference.scalar())) {
      recognition_.note({.kind = Decision::Kind::sign, .node = *node},
                        [&] { return fmt::format("'{}'", difference.get_str()); });
    }
    return (*a == *b) == asked_equal ? Condition::always() : Condition::never();
  }
  const Condition same = saltus::model::equal(casadi::SX(*left), casadi::SX(*right),
                                              expression::difference_text(binary.left, binary.right),
                                              expression::difference_text(binary.right, binary.left));
  return asked_equal ? same : !same;
}

}  // namespace saltus::model
