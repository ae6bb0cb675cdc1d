#include <algorithm>
#include <array>
#include <string_view>

#include "saltus/expression/parser.hpp"
#include "saltus/model/optimal_control/ocp_checks_internal.hpp"

namespace saltus::model {
namespace {

using expression::Binary;
using expression::BinaryOperator;
using expression::Node;
using expression::NodePtr;

std::string text_without_parentheses(Node node) {
  node.parenthesised = false;
  return expression::to_text(node);
}

/// Every expression under the names that its switching functions have without a name of their own.
class PlacesOfNames {
 public:
  explicit PlacesOfNames(std::map<std::string, SourceLocation>& places) : places_(places) {}

  void look(const NodePtr& node) {
    if (!node) return;
    if (const auto* call = std::get_if<expression::Call>(&node->value)) look(*call, *node);
    if (const auto* unary = std::get_if<expression::Unary>(&node->value)) look(unary->operand);
    if (const auto* binary = std::get_if<Binary>(&node->value)) {
      if (is_comparison(binary->op)) note_difference(binary->left, binary->right, node->location);
      look(binary->left);
      look(binary->right);
    }
  }
  void look(const std::vector<NamedExpression>& list) {
    for (const auto& entry : list) look(entry.expression);
  }
  void look(const OcpDescription& problem) {
    look(problem.running_cost);
    look(problem.terminal_cost);
    for (const auto* constraints : {&problem.path_constraints, &problem.terminal_constraints}) {
      for (const auto& constraint : *constraints) look(constraint.sides);
    }
    for (const auto& pair : problem.path_complementarities) look(std::vector{pair.first, pair.second});
    for (const auto& term : problem.least_squares) {
      look(term.of);
      look(term.reference);
    }
  }

 private:
  void look(const std::vector<NodePtr>& nodes) {
    for (const auto& node : nodes) look(node);
  }
  static bool is_comparison(BinaryOperator op) { return op >= BinaryOperator::less && op <= BinaryOperator::not_equal; }

  void look(const expression::Call& call, const Node& node) {
    constexpr std::array<std::string_view, 3> of_signs{"step", "sign", "abs"};
    places_.try_emplace(text_without_parentheses(node), node.location);
    if (std::find(of_signs.begin(), of_signs.end(), call.function) != of_signs.end())
      places_.try_emplace(expression::to_text(*call.arguments.front()), node.location);
    if (call.function == "max" || call.function == "min")
      note_difference(call.arguments.front(), call.arguments.back(), node.location);
    for (const auto& argument : call.arguments) look(argument);
  }

  /// Beside a 0 the other side is the name.
  void note_difference(const NodePtr& a, const NodePtr& b, const SourceLocation& place) {
    if (expression::to_text(*b) == "0") places_.try_emplace(text_without_parentheses(*a), place);
    if (expression::to_text(*a) == "0") places_.try_emplace(text_without_parentheses(*b), place);
    places_.try_emplace(expression::difference_text(a, b), place);
    places_.try_emplace(expression::difference_text(b, a), place);
  }

  std::map<std::string, SourceLocation>& places_;
};

}  // namespace

std::map<std::string, SourceLocation> switching_places(const Description& description) {
  std::map<std::string, SourceLocation> places;
  for (const auto& declared : description.switching) places.try_emplace(declared.name, declared.location);
  PlacesOfNames names(places);
  names.look(description.dynamics);
  for (const auto& mode : description.modes) {
    names.look(mode.when);
    names.look(mode.dynamics);
  }
  if (description.mechanics) {
    for (const auto& force : description.mechanics->force) names.look(force.force);
  }
  names.look(description.definitions);
  names.look(description.outputs);
  if (!description.optimize) return places;
  names.look(*description.optimize);
  return places;
}

}  // namespace saltus::model
