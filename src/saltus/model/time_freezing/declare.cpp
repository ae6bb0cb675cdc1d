// States of a frozen system, and its numbers.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "saltus/model/time_freezing/freeze_internal.hpp"

namespace saltus::model {
namespace {

enum class Range { positive, not_negative, positive_or_infinite };

/// What is wrong with a number of [time_freezing].
std::optional<Error> find_mistake(const std::string& name, double value, Range range, const SourceLocation& location) {
  const bool is_number = range == Range::positive_or_infinite ? !std::isnan(value) : std::isfinite(value);
  const bool may_vanish = range == Range::not_negative;
  if (is_number && (value > 0.0 || (may_vanish && value == 0.0))) return std::nullopt;
  return Error{ErrorCode::invalid_model,
               fmt::format("{} is {}", name, value),
               may_vanish ? "it is a number that is 0 or positive" : "it is a positive number",
               location,
               {location.line > 0 ? "in [time_freezing]" : "in time_freezing()"}};
}

int declare_state(Recognition& recognition, Statement& statement, const std::string& name,
                  const SourceLocation& location = {}) {
  const auto index = static_cast<int>(statement.states.size());
  const SXElem symbol = recognition.graph.symbol(name, {.kind = VariableKind::state, .index = index});
  statement.states.push_back({.name = name, .symbol = symbol, .dynamics = SXElem(0.0), .location = location});
  return index;
}

/// A number, or, for an optimisation that begins with another one, a parameter: a variable, so that nothing folds.
void declare_stabilisation(Recognition& recognition, Statement& statement, FreezingPlan& plan) {
  const auto& initial = plan.numbers.stabilisation_initial;
  if (!initial || plan.purpose != FrozenFor::optimisation) return;
  plan.made.stabilisation = static_cast<int>(statement.parameters.size());
  plan.made.stabilisation_initial = *initial;
  const SXElem symbol = recognition.graph.symbol(
      "time_freezing.stabilisation",
      {.kind = VariableKind::control, .index = plan.made.stabilisation, .value = plan.numbers.stabilisation});
  statement.parameters.push_back({"time_freezing.stabilisation", symbol, plan.numbers.stabilisation});
  plan.stabilisation = casadi::SX(symbol);
}

}  // namespace

Expected<FreezingNumbers> freezing_numbers(const Description& description, ModelScope& scope) {
  FreezingNumbers numbers;
  if (!description.clock) return numbers;
  const ClockDescription& stated = *description.clock;
  struct Key {
    const char* name;
    const expression::NodePtr& node;
    double& number;
    Range range = Range::positive;
  };
  double initial = 0.0, stiffness = 0.0;
  for (const auto& key : {Key{"a_n", stated.a_n, numbers.a_n}, Key{"stiffness", stated.stiffness, stiffness},
                          Key{"stabilisation", stated.stabilisation, numbers.stabilisation, Range::not_negative},
                          Key{"stabilisation.initial", stated.stabilisation_initial, initial, Range::not_negative},
                          Key{"speed.lower", stated.speed_lower, numbers.speed_lower},
                          Key{"speed.upper", stated.speed_upper, numbers.speed_upper},
                          Key{"transfer", stated.transfer, numbers.transfer}, Key{"eps_t", stated.eps_t, numbers.eps_t},
                          Key{"correction", stated.correction, numbers.correction, Range::not_negative},
                          Key{"penetration", stated.penetration, numbers.penetration, Range::positive_or_infinite}}) {
    if (!key.node) continue;
    const auto value = scope.value(*key.node, Reach::everything, key.name);
    if (!value) return tl::unexpected(with_context(value.error(), "in [time_freezing]"));
    if (auto error = find_mistake(key.name, *value, key.range, key.node->location)) {
      return tl::unexpected(*error);
    }
    key.number = *value;
  }
  if (stated.stabilisation_initial) numbers.stabilisation_initial = initial;
  return numbers;
}

std::optional<Error> find_mistake(const FreezingNumbers& numbers) {
  struct Key {
    const char* name;
    double value;
    Range range = Range::positive;
  };
  for (const auto& key :
       {Key{"a_n", numbers.a_n}, Key{"transfer", numbers.transfer},
        Key{"stabilisation", numbers.stabilisation, Range::not_negative},
        Key{"stabilisation_initial", numbers.stabilisation_initial.value_or(0.0), Range::not_negative},
        Key{"eps_t", numbers.eps_t}, Key{"correction", numbers.correction, Range::not_negative},
        Key{"penetration", numbers.penetration, Range::positive_or_infinite}, Key{"speed_lower", numbers.speed_lower},
        Key{"speed_upper", numbers.speed_upper}}) {
    if (auto error = find_mistake(key.name, key.value, key.range, {})) return error;
  }
  return std::nullopt;
}

void declare_hidden(Recognition& recognition, Statement& statement, const std::vector<ContactToFreeze>& contacts,
                    FreezingPlan& plan) {
  plan.made.penetration = plan.numbers.penetration;
  plan.stabilisation = plan.numbers.stabilisation;
  if (!contacts.empty()) declare_stabilisation(recognition, statement, plan);
  plan.made.first_hidden = static_cast<int>(statement.states.size());
  for (const auto& contact : contacts) {
    // Names of hidden states have a point in them, which no name of a user has.
    FrozenContact made{.name = contact.name, .is_elastic = contact.restitution > 0.0};
    plan.restitution.push_back(contact.restitution);
    plan.depth.push_back(made.is_elastic ? declare_state(recognition, statement, contact.name + ".depth") : -1);
    if (plan.purpose == FrozenFor::simulation) {
      made.impulse = declare_state(recognition, statement, contact.name + ".impulse");
      declare_state(recognition, statement, contact.name + ".impulse_t");
      if (contact.in_plane) declare_state(recognition, statement, contact.name + ".impulse_t2");
    }
    plan.made.contacts.push_back(std::move(made));
  }
  plan.takes_plane = plan.purpose == FrozenFor::optimisation && plan.made.hysteresis.size() == 1 && contacts.empty();
}

std::optional<Error> declare_frozen(const Description& description, ModelScope& scope, Recognition& recognition,
                                    Statement& statement, FreezingPlan& plan) {
  // First the names: what is a number may be written by one of them, which is a mistake.
  for (const auto& entry : description.hysteresis) {
    plan.made.hysteresis.push_back({entry.name, declare_state(recognition, statement, entry.name, entry.location)});
    recognition.take_as_two_valued(statement.states.back().symbol);
  }
  const auto numbers = freezing_numbers(description, scope);
  if (!numbers) return numbers.error();
  plan.numbers = *numbers;
  std::vector<ContactToFreeze> contacts;
  for (const auto& contact : description.contacts) {
    contacts.push_back({.name = contact.name, .in_plane = contact.tangents.size() == 2});
    if (!contact.restitution) continue;
    const auto restitution = scope.expression(*contact.restitution);
    if (!restitution) return with_context(restitution.error(), "in [[contacts]]");
    // One that varies is refused with the contacts.
    contacts.back().restitution = recognition.parameter_value(*restitution).value_or(0.0);
  }
  declare_hidden(recognition, statement, contacts, plan);
  const bool has_indicators = std::any_of(description.modes.begin(), description.modes.end(),
                                          [](const auto& mode) { return mode.indicator != nullptr; });
  plan.takes_plane = plan.takes_plane && !has_indicators;
  plan.made.clock = declare_state(recognition, statement, clock_name);
  plan.numerical_time = statement.time;
  statement.time = statement.states.back().symbol;
  return std::nullopt;
}

}  // namespace saltus::model
