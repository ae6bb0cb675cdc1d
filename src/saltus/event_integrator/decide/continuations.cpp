#include "saltus/event_integrator/decide/continuations.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>

#include "saltus/event_integrator/decide/transition_internal.hpp"
#include "saltus/event_integrator/mode/resolution.hpp"

namespace saltus::event_integrator {
namespace {

/// The same mode with the same selections: on an intersection there may be two sliding motions.
bool is_same(const ModeState& a, const ModeState& b) {
  const auto near = [](double first, double second) { return std::abs(first - second) <= same_selection; };
  return a.mode == b.mode && std::equal(a.alpha.begin(), a.alpha.end(), b.alpha.begin(), near);
}

}  // namespace

std::optional<Transition> decide_with(const SwitchingContext& switching_context, const ModeState& before,
                                      const SwitchingPoint& switching_point, const std::vector<GivenMode>& given) {
  ModeState fixed = before;
  SwitchingPoint rest = switching_point;
  for (const auto& [surface, mode, alpha] : given) {
    set_surface(fixed, surface, mode, mode > 0 ? 1.0 : mode < 0 ? 0.0 : std::isfinite(alpha) ? alpha : 0.5);
    for (auto* surfaces :
         {&rest.at_zero, &rest.touched, &rest.exit_below, &rest.exit_above, &rest.coalesced, &rest.destabilised}) {
      std::erase(*surfaces, surface);
    }
  }
  std::string problem;
  if (rest.at_zero.empty() && slides_on_dependent(switching_context, fixed, switching_point)) {
    return check_dependent(switching_context, fixed, switching_point, problem);
  }
  // What the given modes change may concern every other surface here.
  rest.touched = rest.at_zero;
  Transition decided = decide_mode(switching_context, fixed, rest);
  if (decided.termination != result::Termination::completed) return std::nullopt;
  Transition checked = check_forced_mode(switching_context, decided.state, switching_point);
  if (checked.termination != result::Termination::completed) return std::nullopt;
  checked.reason = std::move(decided.reason);
  checked.unique = decided.unique;
  return checked;
}

void other_continuations(const SwitchingContext& switching_context, const ModeState& before,
                         const SwitchingPoint& switching_point, Transition& transition) {
  for (const auto& choice : transition.other_choices) {
    auto other = decide_with(switching_context, before, switching_point, choice);
    if (!other || is_same(other->state, transition.state)) continue;
    const bool known = std::any_of(transition.alternatives.begin(), transition.alternatives.end(),
                                   [&](const Transition& t) { return is_same(other->state, t.state); });
    if (!known) transition.alternatives.push_back(std::move(*other));
  }
}

Transition alternative_of(Transition decided, std::size_t alternative) {
  std::vector<Transition> others = std::move(decided.alternatives);
  others[alternative].meeting = decided.meeting;
  decided.alternatives.clear();
  Transition taken = std::move(others[alternative]);
  others.erase(others.begin() + static_cast<std::ptrdiff_t>(alternative));
  others.insert(others.begin(), std::move(decided));
  taken.alternatives = std::move(others);
  taken.unique = false;
  taken.reason = "followed as a branch" + (taken.reason.empty() ? "" : "; " + taken.reason);
  return taken;
}

}  // namespace saltus::event_integrator
