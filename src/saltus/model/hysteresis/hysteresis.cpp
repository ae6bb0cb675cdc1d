#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "saltus/base/preparation.hpp"
#include "saltus/model/hysteresis/hysteresis_internal.hpp"
#include "saltus/model/statement/start_values_internal.hpp"

namespace saltus::model {
namespace {

Error hysteresis_error(const SourceLocation& location, std::string message, std::string remedy) {
  return {ErrorCode::invalid_model, std::move(message), std::move(remedy), location, {}};
}

std::optional<Error> threshold_mistake(const HysteresisThresholds& thresholds, const ConstantThresholds& numbers) {
  for (const auto& [what, value, location] : {std::tuple{"on", numbers.on, &thresholds.on_location},
                                              std::tuple{"off", numbers.off, &thresholds.off_location}}) {
    if (std::isfinite(value)) continue;
    return hysteresis_error(*location, fmt::format("`{}` of the hysteresis '{}' is {}", what, thresholds.name, value),
                            "a threshold is a finite number; check the parameters in it");
  }
  if (numbers.on != numbers.off) return std::nullopt;
  return hysteresis_error(thresholds.off_location,
                          fmt::format("`on` and `off` of the hysteresis '{}' are both {}", thresholds.name, numbers.on),
                          "give it two different thresholds, or write step(input - threshold)");
}

std::optional<Error> threshold_mistake(Recognition& recognition, const Statement& statement,
                                       const HysteresisThresholds& thresholds) {
  constexpr KindSet allowed = kind_bit(VariableKind::parameter) | kind_bit(VariableKind::time) |
                              kind_bit(VariableKind::alpha) | kind_bit(VariableKind::cell);
  for (const auto& [what, value, location] : {std::tuple{"on", thresholds.on, &thresholds.on_location},
                                              std::tuple{"off", thresholds.off, &thresholds.off_location}}) {
    const auto node = recognition.graph.add(value);
    if (!node) return with_location(node.error(), *location);
    if ((recognition.graph.tape()[*node].reached & ~allowed) == 0 || is_of_parameters(statement, value)) continue;
    return hysteresis_error(
        *location, fmt::format("`{}` of the hysteresis '{}' depends on a state or a control", what, thresholds.name),
        "a threshold is an expression of parameters and t: subtract what moves from both thresholds and from `input`");
  }
  if (const auto numbers = constant_thresholds(recognition, thresholds)) {
    for (const auto& [what, value] : {std::pair{"on", thresholds.on}, std::pair{"off", thresholds.off}}) {
      recognition.note(
          {.kind = Decision::Kind::value, .node = recognition.graph.node(value), .computed = ComputedNumber{}},
          [&, key = what] { return fmt::format("`{}` of '{}'", key, thresholds.name); });
    }
    if (auto mistake = threshold_mistake(thresholds, *numbers)) return mistake;
  }
  if (thresholds.initial != 0.0 && thresholds.initial != 1.0) {
    return hysteresis_error(thresholds.initial_location,
                            fmt::format("the hysteresis '{}' begins with {}", thresholds.name, thresholds.initial),
                            "`initial` is 0 or 1");
  }
  return std::nullopt;
}

/// The side that holds beyond the outer thresholds, whatever it was before; nothing between them.
std::optional<double> outer_side(const ConstantThresholds& thresholds, double input) {
  const double high = thresholds.on > thresholds.off ? 1.0 : 0.0;
  if (input > std::max(thresholds.on, thresholds.off)) return high;
  if (input < std::min(thresholds.on, thresholds.off)) return 1.0 - high;
  return std::nullopt;
}

/// Stops the run where thresholds meet: from both sides, and where they are equal at its start.
void forbid_meeting(Statement& statement, int state, const HysteresisThresholds& thresholds) {
  const casadi::SX on(thresholds.on), off(thresholds.off);
  const auto add = [&](const char* name, Condition meets, bool at_start) {
    JumpStatement jump{.name = thresholds.name + name};
    jump.condition = std::move(meets);
    jump.set.push_back({state, thresholds.on, thresholds.location});
    jump.at_start = at_start;
    jump.priority = 1.0;  // before the jump of the hysteresis, whose thresholds have changed places
    jump.forbidden = fmt::format("`on` and `off` of the hysteresis '{}' meet", thresholds.name);
    jump.location = jump.when_location = jump.delay_location = thresholds.location;
    statement.jumps.push_back(std::move(jump));
  };
  add(".on_falls", less_equal(on, off), false);
  add(".on_rises", greater_equal(on, off), false);
  add(".equal", less_equal(on, off) && greater_equal(on, off), true);
}

/// Where the jump happens: `on` is the higher threshold, or `off` is, always or at that time.
Condition beyond_threshold(const casadi::SX& w, const casadi::SX& e, const HysteresisThresholds& thresholds,
                           const std::optional<ConstantThresholds>& numbers) {
  if (numbers) {
    const casadi::SX high = std::max(numbers->on, numbers->off), low = std::min(numbers->on, numbers->off);
    const casadi::SX above = numbers->on > numbers->off ? w : 1.0 - w;
    return (less(above, 0.5) && greater(e, high)) || (greater(above, 0.5) && less(e, low));
  }
  const casadi::SX on(thresholds.on), off(thresholds.off);
  const Condition rises = greater(on, off), falls = less(on, off);
  const Condition to_one = (rises && greater(e, on)) || (falls && less(e, on));
  const Condition to_zero = (rises && less(e, off)) || (falls && greater(e, off));
  return (less(w, 0.5) && to_one) || (greater(w, 0.5) && to_zero);
}

}  // namespace

std::optional<ConstantThresholds> constant_thresholds(Recognition& recognition,
                                                      const HysteresisThresholds& thresholds) {
  const auto on = recognition.parameter_value(thresholds.on), off = recognition.parameter_value(thresholds.off);
  if (!on || !off) return std::nullopt;
  return ConstantThresholds{*on, *off};
}

bool is_of_parameters(const Statement& statement, const SXElem& expression) {
  const auto symbols = casadi::SX::symvar(casadi::SX(expression));
  return std::all_of(symbols.begin(), symbols.end(), [&](const casadi::SX& symbol) {
    return std::any_of(statement.parameters.begin(), statement.parameters.end(), [&](const auto& parameter) {
      return casadi::SX::is_equal(casadi::SX(parameter.symbol), symbol);
    });
  });
}

void declare_hysteresis(const Description& description, Recognition& recognition, Statement& statement) {
  for (const auto& entry : description.hysteresis) {
    const auto index = static_cast<int>(statement.states.size());
    const SXElem symbol = recognition.graph.symbol(entry.name, {.kind = VariableKind::discrete, .index = index});
    statement.states.push_back(
        {.name = entry.name, .symbol = symbol, .dynamics = SXElem(0.0), .location = entry.location});
  }
}

std::optional<Error> begin_hysteresis(Recognition& recognition, Statement& statement, int state, const SXElem& input,
                                      const HysteresisThresholds& thresholds) {
  if (auto mistake = threshold_mistake(recognition, statement, thresholds)) return mistake;
  const auto node = recognition.graph.add(input);
  if (!node) return with_location(node.error(), thresholds.input_location);
  const KindSet moving = recognition.graph.tape()[*node].reached;
  if ((moving & kind_bit(VariableKind::state)) == 0) {
    return hysteresis_error(
        thresholds.input_location,
        fmt::format("the input of the hysteresis '{}' has no state that moves between jumps", thresholds.name),
        "`input` is an expression of such states; what changes at jumps only switches there: a jump "
        "for each threshold");
  }
  constexpr KindSet allowed = kind_bit(VariableKind::state) | kind_bit(VariableKind::discrete) |
                              kind_bit(VariableKind::parameter) | kind_bit(VariableKind::alpha) |
                              kind_bit(VariableKind::cell);
  if ((moving & ~allowed) != 0) {
    return hysteresis_error(
        thresholds.input_location,
        fmt::format("the input of the hysteresis '{}' depends on t or on a control", thresholds.name),
        "`input` is an expression of states and parameters; give time or the control a state of its own");
  }
  auto& stated = statement.states[at(state)];
  stated.initial = thresholds.initial;
  const double start = value_at_start(recognition, statement, *node);
  const auto numbers = constant_thresholds(recognition, thresholds);
  const auto side = numbers ? outer_side(*numbers, start) : std::nullopt;
  if (side && *side != thresholds.initial) {
    stated.initial = *side;
    statement.warnings.push_back(located(
        thresholds.location, fmt::format("the input of the hysteresis '{}' is {} at the start, beyond its thresholds: "
                                         "it begins with {} instead of {}",
                                         thresholds.name, start, *side, thresholds.initial)));
  }
  recognition.graph.set_value(recognition.graph.tape()[recognition.graph.node(stated.symbol)].variable, stated.initial);
  return std::nullopt;
}

std::optional<Error> state_hysteresis(Recognition& recognition, Statement& statement, int state, const SXElem& input,
                                      const HysteresisThresholds& thresholds) {
  if (auto error = begin_hysteresis(recognition, statement, state, input, thresholds)) return error;
  const auto& stated = statement.states[at(state)];
  const auto numbers = constant_thresholds(recognition, thresholds);
  JumpStatement jump{.name = thresholds.name};
  jump.condition = beyond_threshold(casadi::SX(stated.symbol), casadi::SX(input), thresholds, numbers);
  jump.set.push_back({state, SXElem(1.0) - stated.symbol, thresholds.location});
  jump.at_start = true;
  jump.location = jump.when_location = jump.delay_location = thresholds.location;
  statement.jumps.push_back(std::move(jump));
  if (!numbers) forbid_meeting(statement, state, thresholds);
  return std::nullopt;
}

std::optional<Error> state_all_hysteresis(const Description& description, ModelScope& scope,
                                          const std::map<std::string, double>& initial, const StateHysteresis& take) {
  auto state = static_cast<int>(description.states.size());
  for (const auto& entry : description.hysteresis) {
    prepares("reading the model", at(state) - description.states.size(), description.hysteresis.size());
    HysteresisThresholds thresholds{.name = entry.name,
                                    .location = entry.location,
                                    .input_location = entry.input->location,
                                    .on_location = entry.on->location,
                                    .off_location = entry.off->location};
    thresholds.initial_location = entry.initial ? entry.initial->location : entry.location;
    for (const auto& [node, result] : {std::pair{&entry.on, &thresholds.on}, std::pair{&entry.off, &thresholds.off}}) {
      const auto threshold = scope.expression(**node);
      if (!threshold) return with_context(threshold.error(), "in [[hysteresis]]");
      *result = *threshold;
    }
    if (entry.initial) {
      const auto value = scope.value(*entry.initial, Reach::everything, fmt::format("`initial` of '{}'", entry.name));
      if (!value) return with_context(value.error(), "in [[hysteresis]]");
      thresholds.initial = *value;
    }
    if (const auto set = initial.find(entry.name); set != initial.end()) thresholds.initial = set->second;
    auto input = scope.expression(*entry.input);
    if (!input) return with_context(input.error(), "in [[hysteresis]]");
    if (auto error = take(state++, *input, thresholds)) {
      return with_context(*error, "in [[hysteresis]]");
    }
  }
  return std::nullopt;
}

}  // namespace saltus::model
