#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "saltus/model/statement/discrete_states_internal.hpp"

namespace saltus::model {
namespace {

using expression::BinaryOperator;
using expression::Node;
using expression::UnaryOperator;

/// Values of expressions of numbers.
class Constants {
 public:
  explicit Constants(const Description& description) : description_(description) {}

  /// Nothing for anything but numbers.
  [[nodiscard]] std::optional<double> value(const Node& node) {
    if (const auto* number = std::get_if<expression::Number>(&node.value)) return number->value;
    if (const auto* name = std::get_if<expression::Name>(&node.value)) return definition(name->name);
    if (const auto* unary = std::get_if<expression::Unary>(&node.value)) {
      const auto operand = value(*unary->operand);
      if (!operand || unary->op == UnaryOperator::logical_not) return std::nullopt;
      return unary->op == UnaryOperator::minus ? -*operand : *operand;
    }
    const auto* binary = std::get_if<expression::Binary>(&node.value);
    return binary == nullptr ? std::nullopt : joined(*binary);
  }

 private:
  [[nodiscard]] std::optional<double> definition(const std::string& name) {
    // Nothing while it is being worked out: a cycle, which is refused elsewhere.
    const auto [it, fresh] = definitions_.emplace(name, std::nullopt);
    if (!fresh) return it->second;
    for (const auto& entry : description_.definitions) {
      if (entry.name == name) definitions_[name] = value(*entry.expression);
    }
    return definitions_[name];
  }

  [[nodiscard]] std::optional<double> joined(const expression::Binary& binary) {
    const auto left = value(*binary.left);
    const auto right = left ? value(*binary.right) : std::nullopt;
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

  const Description& description_;
  std::map<std::string, std::optional<double>> definitions_;
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
