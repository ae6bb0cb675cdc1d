// States of a frozen system, and its numbers.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "saltus/model/time_freezing/freeze_internal.hpp"

namespace saltus::model {
namespace {

Error freezing_error(const SourceLocation& location, std::string message, std::string remedy) {
  return {ErrorCode::invalid_model, std::move(message), std::move(remedy), location, {"in [time_freezing]"}};
}

std::optional<Error> take_numbers(const ClockDescription& stated, ModelScope& scope, FreezingNumbers& numbers) {
  struct Key {
    const char* name;
    const expression::NodePtr& node;
    double& number;
    bool may_vanish;
    bool may_be_infinite = false;
  };
  for (const auto& key :
       {Key{"a_n", stated.a_n, numbers.a_n, false}, Key{"stiffness", stated.stiffness, numbers.stiffness, false},
        Key{"stabilisation", stated.stabilisation, numbers.stabilisation, true},
        Key{"stabilisation.initial", stated.stabilisation_initial, numbers.stabilisation_initial, true},
        Key{"transfer", stated.transfer, numbers.transfer, false}, Key{"eps_t", stated.eps_t, numbers.eps_t, false},
        Key{"correction", stated.correction, numbers.correction, true},
        Key{"penetration", stated.penetration, numbers.penetration, false, true}}) {
    if (!key.node) continue;
    const auto value = scope.value(*key.node, Reach::everything, key.name);
    if (!value) return with_context(value.error(), "in [time_freezing]");
    const bool is_number = key.may_be_infinite ? !std::isnan(*value) : std::isfinite(*value);
    if (!is_number || !(*value > 0.0 || (key.may_vanish && *value == 0.0))) {
      return freezing_error(key.node->location, fmt::format("{} is {}", key.name, *value),
                            key.may_vanish ? "it is a number that is 0 or positive" : "it is a positive number");
    }
    key.number = *value;
  }
  return std::nullopt;
}

int declare_state(Recognition& recognition, Statement& statement, const std::string& name,
                  const SourceLocation& location = {}) {
  const auto index = static_cast<int>(statement.states.size());
  const SXElem symbol = recognition.graph.symbol(name, {.kind = VariableKind::state, .index = index});
  statement.states.push_back({.name = name, .symbol = symbol, .dynamics = SXElem(0.0), .location = location});
  return index;
}

/// A number, or, for an optimisation that begins with another one, a parameter: a variable, so that nothing folds.
void declare_stabilisation(const Description& description, Recognition& recognition, Statement& statement,
                           FreezingPlan& plan) {
  plan.stabilisation = plan.numbers.stabilisation;
  const bool is_followed = description.clock && description.clock->stabilisation_initial;
  if (!is_followed || plan.purpose != FrozenFor::optimisation || description.contacts.empty()) return;
  plan.made.stabilisation = static_cast<int>(statement.parameters.size());
  plan.made.stabilisation_initial = plan.numbers.stabilisation_initial;
  const SXElem symbol = recognition.graph.symbol(
      "time_freezing.stabilisation",
      {.kind = VariableKind::control, .index = plan.made.stabilisation, .value = plan.numbers.stabilisation});
  statement.parameters.push_back({"time_freezing.stabilisation", symbol, plan.numbers.stabilisation});
  plan.stabilisation = casadi::SX(symbol);
}

}  // namespace

std::optional<Error> declare_frozen(const Description& description, ModelScope& scope, Recognition& recognition,
                                    Statement& statement, FreezingPlan& plan) {
  if (description.clock) {
    if (auto error = take_numbers(*description.clock, scope, plan.numbers)) return error;
  }
  plan.made.penetration = plan.numbers.penetration;
  declare_stabilisation(description, recognition, statement, plan);
  for (const auto& entry : description.hysteresis) {
    plan.made.hysteresis.push_back({entry.name, declare_state(recognition, statement, entry.name, entry.location)});
  }
  plan.made.first_hidden = static_cast<int>(statement.states.size());
  for (const auto& contact : description.contacts) {
    double restitution = 0.0;
    if (contact.restitution) {
      const auto value = scope.value(*contact.restitution, Reach::everything, "the restitution");
      if (!value) return with_context(value.error(), "in [[contacts]]");
      restitution = *value;
    }
    // Names of hidden states have a point in them, which no name of a user has.
    FrozenContact made{.name = contact.name, .is_elastic = restitution > 0.0};
    plan.restitution.push_back(restitution);
    plan.depth.push_back(made.is_elastic ? declare_state(recognition, statement, contact.name + ".depth") : -1);
    if (plan.purpose == FrozenFor::simulation) {
      made.impulse = declare_state(recognition, statement, contact.name + ".impulse");
      declare_state(recognition, statement, contact.name + ".impulse_t");
      if (contact.tangents.size() == 2) declare_state(recognition, statement, contact.name + ".impulse_t2");
    }
    plan.made.contacts.push_back(std::move(made));
  }
  const bool has_indicators = std::any_of(description.modes.begin(), description.modes.end(),
                                          [](const auto& mode) { return mode.indicator != nullptr; });
  plan.takes_plane = plan.purpose == FrozenFor::optimisation && description.hysteresis.size() == 1 &&
                     description.contacts.empty() && !has_indicators;
  plan.made.clock = declare_state(recognition, statement, clock_name);
  plan.numerical_time = statement.time;
  statement.time = statement.states.back().symbol;
  return std::nullopt;
}

}  // namespace saltus::model
