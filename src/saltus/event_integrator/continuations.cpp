#include "saltus/event_integrator/continuations.hpp"

#include <algorithm>

namespace saltus::event_integrator {

std::optional<Transition> decide_with(const Surroundings& surroundings, const ModeState& before,
                                      const Occasion& occasion, const std::vector<std::pair<int, int>>& given) {
  ModeState fixed = before;
  Occasion rest = occasion;
  for (const auto& [surface, mode] : given) {
    set_surface(fixed, surface, mode, mode > 0 ? 1.0 : mode < 0 ? 0.0 : 0.5);
    for (auto* surfaces : {&rest.at_zero, &rest.touched, &rest.exit_below, &rest.exit_above}) {
      std::erase(*surfaces, surface);
    }
  }
  // What the given modes change may concern every other surface here.
  rest.touched = rest.at_zero;
  Transition decided = decide_mode(surroundings, fixed, rest);
  if (decided.termination != result::Termination::completed) return std::nullopt;
  Transition checked = check_forced_mode(surroundings, decided.state, occasion);
  if (checked.termination != result::Termination::completed) return std::nullopt;
  checked.reason = std::move(decided.reason);
  checked.unique = decided.unique;
  return checked;
}

void other_continuations(const Surroundings& surroundings, const ModeState& before, const Occasion& occasion,
                         Transition& transition) {
  for (const auto& choice : transition.other_choices) {
    const auto other = decide_with(surroundings, before, occasion, {choice});
    if (!other || other->state.mode == transition.state.mode) continue;
    const bool known = std::any_of(transition.alternatives.begin(), transition.alternatives.end(),
                                   [&](const Continuation& c) { return c.mode == other->state.mode; });
    if (!known) transition.alternatives.push_back({other->state.mode, other->state.alpha});
  }
}

}  // namespace saltus::event_integrator
