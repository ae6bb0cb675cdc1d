#include <algorithm>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "saltus/expression/parser.hpp"
#include "saltus/model/optimal_control/with_slacks_internal.hpp"

namespace saltus::model {
namespace {

using expression::Binary;
using expression::BinaryOperator;
using expression::Call;
using expression::Name;
using expression::Node;
using expression::NodePtr;
using expression::Number;
using expression::Unary;
using expression::UnaryOperator;

/// Of a constraint with kinks that mix states and controls: each is a row at every point.
constexpr std::size_t most_branches = 64;

template <class Value>
NodePtr made(Value value, const SourceLocation& location) {
  auto node = std::make_shared<Node>();
  node->value = std::move(value);
  node->location = location;
  return node;
}

NodePtr negative(const NodePtr& node) { return made(Unary{UnaryOperator::minus, node}, node->location); }
NodePtr less(const NodePtr& left, const NodePtr& right) {
  return made(Binary{BinaryOperator::subtract, left, right}, left->location);
}

Curvature flipped(Curvature curvature) {
  if (curvature == Curvature::convex) return Curvature::concave;
  return curvature == Curvature::concave ? Curvature::convex : Curvature::linear;
}

bool is_kink(const Call& call) {
  return call.function == "abs" || call.function == "max" || call.function == "min" || call.function == "if" ||
         call.function == "sign" || call.function == "step";
}

/// The value of an expression of numbers and parameters; nothing for functions and other names.
std::optional<double> constant_of(const Node& node, const Description& description) {
  if (const auto* number = std::get_if<Number>(&node.value)) return number->value;
  if (const auto* name = std::get_if<Name>(&node.value)) {
    for (const auto& free : description.free_parameters) {
      if (free.name == name->name) return std::nullopt;
    }
    for (const auto& parameter : description.parameters) {
      if (parameter.name == name->name) return constant_of(*parameter.expression, description);
    }
    return std::nullopt;
  }
  if (const auto* unary = std::get_if<Unary>(&node.value)) {
    const auto operand = constant_of(*unary->operand, description);
    if (!operand || unary->op == UnaryOperator::logical_not) return std::nullopt;
    return unary->op == UnaryOperator::minus ? -*operand : *operand;
  }
  if (const auto* binary = std::get_if<Binary>(&node.value)) {
    const auto left = constant_of(*binary->left, description);
    const auto right = constant_of(*binary->right, description);
    if (!left || !right) return std::nullopt;
    if (binary->op == BinaryOperator::add) return *left + *right;
    if (binary->op == BinaryOperator::subtract) return *left - *right;
    if (binary->op == BinaryOperator::multiply) return *left * *right;
    if (binary->op == BinaryOperator::divide && *right != 0.0) return *left / *right;
  }
  return std::nullopt;
}

/// Calls visit(child) for every operand of a node.
template <class Visit>
void for_each_operand(const Node& node, Visit&& visit) {
  if (const auto* unary = std::get_if<Unary>(&node.value)) visit(*unary->operand);
  if (const auto* binary = std::get_if<Binary>(&node.value)) {
    visit(*binary->left);
    visit(*binary->right);
  }
  if (const auto* call = std::get_if<Call>(&node.value)) {
    for (const auto& argument : call->arguments) visit(*argument);
  }
}

Error not_convex(const Node& node, const std::string& place) {
  return {ErrorCode::invalid_model,
          fmt::format("the kink '{}' of controls does not enter {} convexly", expression::to_text(node), place),
          "abs and max of controls may stand in a cost with a positive factor, or left of <=; replace it by a control "
          "of your own with constraints elsewhere",
          node.location,
          {"in [optimize]"}};
}

}  // namespace

ControlSlacks::ControlSlacks(const Description& description)
    : description_(description), user_controls_(static_cast<int>(description.controls.size())) {
  description_.inputs.clear();
  description_.sampled_inputs.clear();
}

const NodePtr* ControlSlacks::definition(const std::string& name) const {
  for (const auto* list : {&description_.definitions, &description_.outputs}) {
    for (const auto& entry : *list) {
      if (entry.name == name) return &entry.expression;
    }
  }
  return nullptr;
}

bool ControlSlacks::speaks_of_controls(const Node& node) const {
  if (const auto* name = std::get_if<Name>(&node.value)) {
    for (const auto& control : description_.controls) {
      if (control.name == name->name) return true;
    }
    const auto* meaning = definition(name->name);
    return meaning != nullptr && speaks_of_controls(**meaning);
  }
  bool found = false;
  for_each_operand(node, [&](const Node& operand) { found = found || speaks_of_controls(operand); });
  return found;
}

bool ControlSlacks::has_kink_of_controls(const Node& node) const {
  if (const auto* name = std::get_if<Name>(&node.value)) {
    const auto* meaning = definition(name->name);
    return meaning != nullptr && has_kink_of_controls(**meaning);
  }
  if (const auto* call = std::get_if<Call>(&node.value); call != nullptr && is_kink(*call)) {
    return speaks_of_controls(node);
  }
  bool found = false;
  for_each_operand(node, [&](const Node& operand) { found = found || has_kink_of_controls(operand); });
  return found;
}

/// The first name in an expression that is neither a control nor a parameter; empty if there is none.
std::string ControlSlacks::not_of_controls(const Node& node) const {
  if (const auto* name = std::get_if<Name>(&node.value)) {
    if (const auto* meaning = definition(name->name)) return not_of_controls(**meaning);
    const auto among = [&](const auto& list) {
      return std::any_of(list.begin(), list.end(), [&](const auto& one) { return one.name == name->name; });
    };
    const bool known = name->name == "pi" || among(description_.controls) || among(description_.parameters);
    return known ? std::string() : name->name;
  }
  std::string found;
  for_each_operand(node, [&](const Node& operand) {
    if (found.empty()) found = not_of_controls(operand);
  });
  return found;
}

bool ControlSlacks::has_mixed_kink(const Node& node) const {
  if (const auto* name = std::get_if<Name>(&node.value)) {
    const auto* meaning = definition(name->name);
    return meaning != nullptr && has_mixed_kink(**meaning);
  }
  if (const auto* call = std::get_if<Call>(&node.value); call != nullptr && is_kink(*call)) {
    if (speaks_of_controls(node) && !not_of_controls(node).empty()) return true;
  }
  bool found = false;
  for_each_operand(node, [&](const Node& operand) { found = found || has_mixed_kink(operand); });
  return found;
}

Expected<NodePtr> ControlSlacks::in_running_cost(const NodePtr& expression, const std::string& place) {
  mixed_ = Mixed::slack_per_stage;
  return replace(expression, Curvature::convex, place);
}

Expected<NodePtr> ControlSlacks::in_terminal_cost(const NodePtr& expression, const std::string& place) {
  mixed_ = Mixed::refused;
  return replace(expression, Curvature::convex, place);
}

Expected<std::vector<NodePtr>> ControlSlacks::in_constraint(const NodePtr& expression, Curvature curvature,
                                                            const std::string& place) {
  mixed_ = has_mixed_kink(*expression) ? Mixed::branch : Mixed::refused;
  chosen_.clear();
  std::vector<NodePtr> all;
  for (;;) {
    kinks_seen_ = 0;
    choices_.clear();
    auto one = replace(expression, curvature, place);
    if (!one) return tl::unexpected(one.error());
    all.push_back(*one);
    if (all.size() > most_branches) {
      return tl::unexpected(
          Error{ErrorCode::not_available,
                fmt::format("the kinks of controls in {} have more than {} branches", place, most_branches),
                "state parts of it as constraints of their own",
                expression->location,
                {"in [optimize]"}});
    }
    // The next combination: the last kink that has another argument takes it, those behind it begin anew.
    std::size_t last = choices_.size();
    while (last > 0 && chosen_[last - 1] + 1 == choices_[last - 1]) --last;
    if (last == 0) return all;
    chosen_.resize(last);
    ++chosen_[last - 1];
  }
}

Expected<NodePtr> ControlSlacks::replace(const NodePtr& node, Curvature curvature, const std::string& place) {
  if (!has_kink_of_controls(*node)) return node;
  if (const auto* name = std::get_if<Name>(&node->value)) return replace(*definition(name->name), curvature, place);
  if (const auto* unary = std::get_if<Unary>(&node->value)) {
    const bool minus = unary->op == UnaryOperator::minus;
    auto operand = replace(unary->operand, minus ? flipped(curvature) : curvature, place);
    if (!operand) return operand;
    return made(Unary{unary->op, *operand}, node->location);
  }
  if (std::holds_alternative<Binary>(node->value)) return in_binary(node, curvature, place);
  const auto& call = std::get<Call>(node->value);
  if (!is_kink(call)) return tl::unexpected(not_convex(*node, place));
  return slack(node, curvature, place);
}

Expected<NodePtr> ControlSlacks::in_binary(const NodePtr& node, Curvature curvature, const std::string& place) {
  const auto& binary = std::get<Binary>(node->value);
  Curvature of_left = Curvature::linear;
  Curvature of_right = Curvature::linear;
  const auto times = [curvature](std::optional<double> factor) {
    if (!factor) return Curvature::linear;
    return *factor >= 0.0 ? curvature : flipped(curvature);
  };
  if (binary.op == BinaryOperator::add) {
    of_left = of_right = curvature;
  } else if (binary.op == BinaryOperator::subtract) {
    of_left = curvature;
    of_right = flipped(curvature);
  } else if (binary.op == BinaryOperator::multiply) {
    of_left = times(constant_of(*binary.right, description_));
    of_right = times(constant_of(*binary.left, description_));
  } else if (binary.op == BinaryOperator::divide) {
    of_left = times(constant_of(*binary.right, description_));
  }
  auto left = replace(binary.left, of_left, place);
  if (!left) return left;
  auto right = replace(binary.right, of_right, place);
  if (!right) return right;
  return made(Binary{binary.op, *left, *right}, node->location);
}

Expected<NodePtr> ControlSlacks::slack(const NodePtr& node, Curvature curvature, const std::string& place) {
  const auto call = std::get<Call>(node->value);
  const bool from_above = (call.function == "abs" || call.function == "max") && curvature == Curvature::convex;
  const bool from_below = call.function == "min" && curvature == Curvature::concave;
  if (!from_above && !from_below) return tl::unexpected(not_convex(*node, place));
  if (mixed_ == Mixed::branch) return branch(node, curvature, place);
  const std::string other = not_of_controls(*node);
  const bool at_stages = !other.empty();
  if (at_stages && mixed_ == Mixed::refused) {
    return tl::unexpected(
        Error{ErrorCode::not_available,
              fmt::format("'{}' in {} mixes controls with '{}' in one kink", expression::to_text(*node), place, other),
              "make the kink one of controls and parameters alone, or one of states alone",
              node->location,
              {"in [optimize]"}});
  }
  const std::string name =
      fmt::format("saltus_slack_{}", static_cast<int>(description_.controls.size()) - user_controls_ + 1);
  const NodePtr symbol = made(Name{name}, node->location);
  ControlDescription control;
  control.name = name;
  control.location = node->location;
  if (at_stages) {
    // Its values are those of the stages: the one of the interval stays at 0.
    control.lower = control.upper = made(Number{0.0}, node->location);
    stage_slacks_.push_back(static_cast<int>(description_.controls.size()));
  }
  description_.controls.push_back(std::move(control));
  for (const auto& argument : call.arguments) {
    auto inner = replace(argument, call.function == "abs" ? Curvature::linear : curvature, place);
    if (!inner) return inner;
    rows_.push_back({from_above ? less(*inner, symbol) : less(symbol, *inner), at_stages});
    if (call.function == "abs") rows_.push_back({less(negative(*inner), symbol), at_stages});
  }
  return symbol;
}

/// The argument of a kink that is chosen now; abs(a) is max(a, -a).
Expected<NodePtr> ControlSlacks::branch(const NodePtr& node, Curvature curvature, const std::string& place) {
  const auto& call = std::get<Call>(node->value);
  const bool is_abs = call.function == "abs";
  const std::size_t kink = kinks_seen_++;
  if (kink == chosen_.size()) chosen_.push_back(0);
  choices_.push_back(is_abs ? 2 : call.arguments.size());
  const std::size_t argument = chosen_[kink];
  auto inner = replace(call.arguments[is_abs ? 0 : argument], is_abs ? Curvature::linear : curvature, place);
  if (!inner || !is_abs || argument == 0) return inner;
  return negative(*inner);
}

}  // namespace saltus::model
