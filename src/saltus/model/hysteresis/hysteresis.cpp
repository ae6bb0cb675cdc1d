#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "saltus/model/hysteresis/hysteresis_internal.hpp"
#include "saltus/model/statement/start_values_internal.hpp"

namespace saltus::model {
namespace {

Error hysteresis_error(const SourceLocation& location, std::string message, std::string remedy) {
  return {ErrorCode::invalid_model, std::move(message), std::move(remedy), location, {}};
}

std::optional<Error> threshold_mistake(const HysteresisThresholds& thresholds) {
  for (const auto& [what, value, location] : {std::tuple{"on", thresholds.on, &thresholds.on_location},
                                              std::tuple{"off", thresholds.off, &thresholds.off_location}}) {
    if (std::isfinite(value)) continue;
    return hysteresis_error(*location, fmt::format("`{}` of the hysteresis '{}' is {}", what, thresholds.name, value),
                            "a threshold is a finite number; check the parameters in it");
  }
  if (thresholds.on == thresholds.off) {
    return hysteresis_error(
        thresholds.off_location,
        fmt::format("`on` and `off` of the hysteresis '{}' are both {}", thresholds.name, thresholds.on),
        "give it two different thresholds, or write step(input - threshold)");
  }
  if (thresholds.initial != 0.0 && thresholds.initial != 1.0) {
    return hysteresis_error(thresholds.initial_location,
                            fmt::format("the hysteresis '{}' begins with {}", thresholds.name, thresholds.initial),
                            "`initial` is 0 or 1");
  }
  return std::nullopt;
}

/// The side that holds beyond the outer thresholds, whatever it was before; nothing between them.
std::optional<double> outer_side(const HysteresisThresholds& thresholds, double input) {
  const double high = thresholds.on > thresholds.off ? 1.0 : 0.0;
  if (input > std::max(thresholds.on, thresholds.off)) return high;
  if (input < std::min(thresholds.on, thresholds.off)) return 1.0 - high;
  return std::nullopt;
}

}  // namespace

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
  if (auto mistake = threshold_mistake(thresholds)) return mistake;
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
  if (const auto side = outer_side(thresholds, start); side && *side != thresholds.initial) {
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
  const casadi::SX w(stated.symbol), e(input);
  const casadi::SX high = std::max(thresholds.on, thresholds.off), low = std::min(thresholds.on, thresholds.off);
  const bool rises = thresholds.on > thresholds.off;  // 1 above
  const casadi::SX above = rises ? w : 1.0 - w;
  const Condition up = less(above, 0.5) && greater(e, high);
  const Condition down = greater(above, 0.5) && less(e, low);
  JumpStatement jump{.name = thresholds.name};
  jump.condition = up || down;
  jump.set.push_back({state, SXElem(1.0) - stated.symbol, thresholds.location});
  jump.at_start = true;
  jump.location = jump.when_location = jump.delay_location = thresholds.location;
  statement.jumps.push_back(std::move(jump));
  return std::nullopt;
}

std::optional<Error> state_all_hysteresis(const Description& description, ModelScope& scope,
                                          const std::map<std::string, double>& initial, const StateHysteresis& take) {
  auto state = static_cast<int>(description.states.size());
  for (const auto& entry : description.hysteresis) {
    HysteresisThresholds thresholds{.name = entry.name,
                                    .location = entry.location,
                                    .input_location = entry.input->location,
                                    .on_location = entry.on->location,
                                    .off_location = entry.off->location};
    thresholds.initial_location = entry.initial ? entry.initial->location : entry.location;
    for (const auto& [node, result, key] :
         {std::tuple{&entry.on, &thresholds.on, "on"}, std::tuple{&entry.off, &thresholds.off, "off"},
          std::tuple{&entry.initial, &thresholds.initial, "initial"}}) {
      if (*node == nullptr) continue;
      const auto value = scope.value(**node, Reach::everything, fmt::format("`{}` of '{}'", key, entry.name));
      if (!value) return with_context(value.error(), "in [[hysteresis]]");
      *result = *value;
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
