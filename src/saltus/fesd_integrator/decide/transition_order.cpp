// The order in which patterns are asked: the first one that continues the solution is the one it goes on in.
#include <algorithm>
#include <cmath>

#include "saltus/base/at.hpp"
#include "saltus/base/contains.hpp"
#include "saltus/fesd_integrator/decide/surface_modes.hpp"
#include "saltus/fesd_integrator/decide/transition.hpp"

namespace saltus::fesd_integrator {

/// How the step functions that are zero now were there before the point, beside each other. Which of several functions
/// that come to zero at one time is there first is decided by roundings: all of them cross, or none. Where one of them
/// on its other side stops the motion, as a contact stops time, the others would stay at zero for ever.
/// What stands at zero while another function moves has no reason to change.
void Transition::find_approaches(const Decision& decision, const std::vector<int>& members) {
  approaches_.assign(kernel_.selections(), Approach::alone);
  if (decision.before == nullptr) return;
  const ActiveSet& before = *decision.before;
  const auto is_step = [&](int j) { return !parts_[at(part_of_[at(j)])].simplex; };
  if (std::count_if(members.begin(), members.end(), is_step) < 2) return;
  std::vector<double> selections(kernel_.selections());
  const auto middle = before.middle();
  before.selections(middle.data(), selections.data());
  const double rounding = ProjectedField::rounding_of_rates(decision.size, decision.trial_length);
  if (!projected_.solve(decision.t, decision.x.data(), before, decision.held, selections.data(), rounding)) return;
  projected_.rates(rate_);
  std::vector<int> arrived;
  for (const int j : members) {
    if (!is_step(j)) continue;
    if (before.modes()[at(j)] == 0) {
      const double selection = selections[at(j)];
      if (!(std::min(selection, 1.0 - selection) > undecided)) approaches_[at(j)] = Approach::at_bound;
      continue;
    }
    const double moved = before.modes()[at(j)] * rate_[at(j)] * decision.trial_length;
    if (moved < -noise_[at(j)]) arrived.push_back(j);
    if (std::abs(moved) <= noise_[at(j)]) approaches_[at(j)] = Approach::stands;
  }
  for (const int j : arrived) approaches_[at(j)] = arrived.size() > 1 ? Approach::together : Approach::alone;
}

/// How many functions do not what their approach says. Then how many functions, regions or surfaces are in other modes
/// than before, and how many regions are active.
Transition::Rank Transition::rank(const Decision& decision, const Group& group, const std::vector<int>& pattern) const {
  int unlikely = 0, changes = 0, active = 0;
  for (std::size_t k = 0; k < pattern.size(); ++k) {
    const Part& part = parts_[at(part_of_[at(group.members[k])])];
    active += part.simplex && pattern[k] == 0 ? 1 : 0;
    if (decision.before == nullptr) continue;
    const int mode_before = decision.before->modes()[at(group.members[k])];
    const Approach approach = approaches_[at(group.members[k])];
    unlikely += (approach == Approach::together && pattern[k] != -mode_before) ||
                        (approach == Approach::stands && pattern[k] != mode_before)
                    ? 1
                    : 0;
    if (part.surfaces == 0) {
      changes += mode_before != pattern[k] ? 1 : 0;
    } else if (k == 0 || part_of_[at(group.members[k - 1])] != part_of_[at(group.members[k])]) {
      const auto before = modes_before(decision, part);
      const auto modes = surface_modes(part, [&](int region) {
        const auto place = std::find(group.members.begin(), group.members.end(), region);
        return place != group.members.end() && pattern[at(place - group.members.begin())] == 0;
      });
      for (std::size_t s = 0; s < modes.size(); ++s) changes += modes[s] != before[s] ? 1 : 0;
    }
  }
  return {unlikely, changes, active};
}

}  // namespace saltus::fesd_integrator
