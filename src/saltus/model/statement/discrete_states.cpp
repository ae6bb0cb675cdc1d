#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "saltus/expression/parser.hpp"
#include "saltus/model/statement/discrete_states_internal.hpp"

namespace saltus::model {
namespace {

using expression::BinaryOperator;
using expression::Node;
using expression::UnaryOperator;

/// Values of expressions of numbers.
class Constants {
 public:
  explicit Constants(const Description& description) {
    for (const auto& entry : description.definitions) expressions_.emplace(entry.name, &*entry.expression);
  }

  /// Nothing for anything but numbers.
  [[nodiscard]] std::optional<double> value(const Node& node) {
    for (const auto& name : expression::names_in(node)) work_out(name);
    return of_known(node);
  }

 private:
  [[nodiscard]] std::optional<double> of_known(const Node& node) const {
    if (const auto* number = std::get_if<expression::Number>(&node.value)) return number->value;
    if (const auto* name = std::get_if<expression::Name>(&node.value)) return definitions_.at(name->name);
    if (const auto* unary = std::get_if<expression::Unary>(&node.value)) {
      const auto operand = of_known(*unary->operand);
      if (!operand || unary->op == UnaryOperator::logical_not) return std::nullopt;
      return unary->op == UnaryOperator::minus ? -*operand : *operand;
    }
    const auto* binary = std::get_if<expression::Binary>(&node.value);
    return binary == nullptr ? std::nullopt : joined(*binary);
  }

  /// Works out what the definition needs before it, on a stack of its own: chains may be longer than the call stack.
  void work_out(const std::string& name) {
    std::vector<std::string> open = {name};
    while (!open.empty()) {
      const std::string current = open.back();
      const auto stated = expressions_.find(current);
      const bool has_expression = stated != expressions_.end();
      // Nothing while it is being worked out: a cycle, which is refused elsewhere.
      const auto [known, fresh] = definitions_.emplace(current, std::nullopt);
      if (fresh && has_expression) {
        for (const auto& need : expression::names_in(*stated->second)) {
          if (!definitions_.contains(need)) open.push_back(need);
        }
        continue;
      }
      open.pop_back();
      if (has_expression && worked_out_.insert(current).second) {
        definitions_[current] = of_known(*stated->second);
      }
    }
  }

  [[nodiscard]] std::optional<double> joined(const expression::Binary& binary) const {
    const auto left = of_known(*binary.left);
    const auto right = left ? of_known(*binary.right) : std::nullopt;
    if (!right) return std::nullopt;
    switch (binary.op) {
      case BinaryOperator::add:
        return *left + *right;
      case BinaryOperator::subtract:
        return *left - *right;
      case BinaryOperator::multiply:
        return *left * *right;
      case BinaryOperator::divide:
        return *left / *right;
      case BinaryOperator::power:
        return std::pow(*left, *right);
      default:
        return std::nullopt;
    }
  }

  std::unordered_map<std::string_view, const expression::Node*> expressions_;
  std::unordered_map<std::string, std::optional<double>> definitions_;
  std::unordered_set<std::string> worked_out_;
};

}  // namespace

std::vector<bool> discrete_states(const Description& description) {
  Constants constants(description);
  std::unordered_map<std::string_view, std::vector<const expression::Node*>> rates;
  const auto look = [&](const std::vector<NamedExpression>& entries) {
    for (const auto& entry : entries) rates[entry.name].push_back(&*entry.expression);
  };
  look(description.dynamics);
  for (const auto& mode : description.modes) look(mode.dynamics);
  std::vector<bool> result;
  for (const auto& state : description.states) {
    const auto stated = rates.find(state.name);
    result.push_back(stated != rates.end() &&
                     std::all_of(stated->second.begin(), stated->second.end(),
                                 [&](const expression::Node* rate) { return constants.value(*rate) == 0.0; }));
  }
  return result;
}

}  // namespace saltus::model
