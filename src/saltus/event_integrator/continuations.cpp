#include "saltus/event_integrator/continuations.hpp"

#include <algorithm>
#include <cmath>

namespace saltus::event_integrator {
namespace {

/// The same mode with the same selections: on an intersection there may be two sliding motions.
bool is_same(const ModeState& state, const std::vector<int>& mode, const std::vector<double>& alpha) {
  const auto near = [](double a, double b) { return std::abs(a - b) <= 1e-6; };
  return state.mode == mode && std::equal(alpha.begin(), alpha.end(), state.alpha.begin(), near);
}

}  // namespace

std::optional<Transition> decide_with(const Surroundings& surroundings, const ModeState& before,
                                      const Occasion& occasion, const std::vector<GivenMode>& given) {
  ModeState fixed = before;
  Occasion rest = occasion;
  for (const auto& [surface, mode, alpha] : given) {
    set_surface(fixed, surface, mode, mode > 0 ? 1.0 : mode < 0 ? 0.0 : std::isfinite(alpha) ? alpha : 0.5);
    for (auto* surfaces :
         {&rest.at_zero, &rest.touched, &rest.exit_below, &rest.exit_above, &rest.coalesced, &rest.destabilised}) {
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
    const auto other = decide_with(surroundings, before, occasion, choice);
    if (!other || is_same(other->state, transition.state.mode, transition.state.alpha)) continue;
    const bool known = std::any_of(transition.alternatives.begin(), transition.alternatives.end(),
                                   [&](const Continuation& c) { return is_same(other->state, c.mode, c.alpha); });
    if (!known) transition.alternatives.push_back({other->state.mode, other->state.alpha});
  }
}

}  // namespace saltus::event_integrator
