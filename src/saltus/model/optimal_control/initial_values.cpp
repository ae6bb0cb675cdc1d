#include <algorithm>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "saltus/expression/parser.hpp"
#include "saltus/model/mistakes.hpp"
#include "saltus/model/optimal_control/initial_values_internal.hpp"

namespace saltus::model {
namespace {

using expression::NodePtr;

Error no_state(const expression::Node& argument, const std::vector<StateDescription>& states) {
  std::vector<std::string> names;
  for (const auto& state : states) names.push_back(state.name);
  const std::string text = expression::to_text(argument);
  return {ErrorCode::invalid_model,
          fmt::format("expected the name of a state in initial(...), found '{}'", text),
          suggest(text, names),
          argument.location,
          {"in [optimize]"}};
}

}  // namespace

InitialValues::InitialValues(const Description& description, const std::vector<Override>& overrides)
    : description_(description) {
  if (description_.optimize) {
    auto& problem = *description_.optimize;
    problem.terminal_cost = replaced(problem.terminal_cost);
    for (auto& constraint : problem.terminal_constraints) {
      for (auto& side : constraint.sides) side = replaced(side);
    }
  }
  overrides_ = with_parameters(overrides);
}

std::vector<Override> InitialValues::with_parameters(std::vector<Override> overrides) const {
  const std::size_t stated = overrides.size();
  for (std::size_t i = 0; i < stated; ++i) {
    if (std::find(states_.begin(), states_.end(), overrides[i].name) == states_.end()) continue;
    overrides.push_back({parameter_of(overrides[i].name), overrides[i].value});
  }
  return overrides;
}

NodePtr InitialValues::replaced(const NodePtr& node) {
  if (!node) return node;
  auto made = std::make_shared<expression::Node>(*node);
  if (auto* unary = std::get_if<expression::Unary>(&made->value)) unary->operand = replaced(unary->operand);
  if (auto* binary = std::get_if<expression::Binary>(&made->value)) {
    binary->left = replaced(binary->left);
    binary->right = replaced(binary->right);
  }
  if (auto* call = std::get_if<expression::Call>(&made->value)) {
    if (call->function == "initial") return parameter(*call, node->location);
    for (auto& argument : call->arguments) argument = replaced(argument);
  }
  return made;
}

NodePtr InitialValues::parameter(const expression::Call& call, const SourceLocation& location) {
  const auto& argument = *call.arguments.front();
  const auto* name = std::get_if<expression::Name>(&argument.value);
  const auto& states = description_.states;
  const auto state = std::find_if(states.begin(), states.end(),
                                  [&](const auto& one) { return name != nullptr && one.name == name->name; });
  auto made = std::make_shared<expression::Node>();
  made->location = location;
  if (state == states.end()) {
    if (!error_) error_ = no_state(argument, states);
    made->value = expression::Number{0.0};
    return made;
  }
  made->value = expression::Name{parameter_of(state->name)};
  if (std::find(states_.begin(), states_.end(), state->name) != states_.end()) return made;
  states_.push_back(state->name);
  description_.parameters.push_back({parameter_of(state->name), state->initial, state->location});
  if (state->free) {
    description_.free_parameters.push_back({parameter_of(state->name), state->lower, state->upper, state->location});
  }
  return made;
}

}  // namespace saltus::model
