// Where inequalities of modes are equalities: the hidden dynamics decides by velocities alone, which vanish there.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "saltus/event_integrator/decide/transition_internal.hpp"

namespace saltus::event_integrator {

std::optional<Transition> borderline_mode(const SwitchingContext& s, const ModeState& before,
                                          const SwitchingPoint& switching_point, const ModeState& failed) {
  const auto& surfaces = switching_point.at_zero;
  if (!s.affine_in_alpha || !s.kernel.region_groups().empty()) return std::nullopt;
  for (int j = 0; j < s.kernel.switching_functions(); ++j) {
    const auto& inner = s.kernel.inner(j);
    if (std::any_of(inner.begin(), inner.end(), [&](int i) { return contains(surfaces, i); })) return std::nullopt;
  }
  if (surfaces.empty() || surfaces.size() > at(switching::largest_enumerated)) return std::nullopt;
  const ProjectedFields fields(s.kernel, switching_point);
  auto modes = switching::admissible_modes(fields.table(before, surfaces), switching::Borderline::kept);
  // Selections at their bounds come last: where a region beside them is left, too, they end at once.
  const auto rank = [&](const switching::GroupMode& candidate) {
    std::size_t changes = 0;
    bool at_bound = false;
    for (std::size_t k = 0; k < surfaces.size(); ++k) {
      changes += candidate.mode[k] != failed.mode[at(surfaces[k])] ? 1U : 0U;
      at_bound = at_bound || (candidate.mode[k] == 0 && std::abs(candidate.alpha[k] - 0.5) >= 0.5 - sign_tolerance);
    }
    return changes + (at_bound ? surfaces.size() + 1 : 0);
  };
  std::stable_sort(modes.begin(), modes.end(), [&](const auto& a, const auto& b) { return rank(a) < rank(b); });
  // Which field was located as tangent says nothing about modes with other selections.
  SwitchingPoint here = switching_point;
  for (auto* surfaces_left : {&here.exit_below, &here.exit_above, &here.coalesced, &here.destabilised}) {
    surfaces_left->clear();
  }
  std::optional<Transition> found;
  for (const auto& candidate : modes) {
    ModeState state = before;
    std::vector<GivenMode> choice;
    for (std::size_t k = 0; k < surfaces.size(); ++k) {
      const double alpha = std::clamp(candidate.alpha[k], 0.0, 1.0);
      set_surface(state, surfaces[k], candidate.mode[k], alpha);
      choice.push_back({surfaces[k], candidate.mode[k], alpha});
    }
    if (found) {
      // That it leads on is found out where it is followed.
      found->unique = false;
      found->other_choices.push_back(std::move(choice));
      continue;
    }
    Transition transition = check_forced_mode(s, state, here);
    if (transition.termination == result::Termination::completed) found = std::move(transition);
  }
  if (found) {
    found->reason = fmt::format("{}: fields are tangent to several surfaces at once; the mode's own field leads on",
                                names(s.layout, surfaces));
  }
  return found;
}

}  // namespace saltus::event_integrator
