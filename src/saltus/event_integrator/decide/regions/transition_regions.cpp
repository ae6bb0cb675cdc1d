// Where three or more regions of a group by `indicator` meet: Stewart's complementarity system decides.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "saltus/event_integrator/decide/transition_internal.hpp"
#include "saltus/event_integrator/mode/resolution.hpp"

namespace saltus::event_integrator {
namespace {

std::vector<ActiveRegion> active_of(const std::vector<int>& candidates, const switching::RegionSet& set) {
  std::vector<ActiveRegion> active;
  for (std::size_t k = 0; k < set.active.size(); ++k) {
    active.push_back({candidates[at(set.active[k])], std::clamp(set.weights[k], 0.0, 1.0)});
  }
  return active;
}

}  // namespace

/// d/dt (g_i - g_r) of all candidates along the field of each; the first of them is the reference r.
switching::RegionRates Decider::region_rates(const std::vector<int>& candidates, double t, const double* x) {
  SwitchingPoint there = switching_point_;
  there.t = t;
  there.x = x;
  const ProjectedFields fields(s_.kernel, there);
  const std::vector<int> others(candidates.begin() + 1, candidates.end());
  const auto n = candidates.size();
  switching::RegionRates rates{static_cast<int>(n), std::vector<double>(n * n, 0.0)};
  for (std::size_t j = 0; j < n; ++j) {
    std::vector<double> alpha = base_.alpha;
    for (const int region : candidates) alpha[at(region)] = 0.0;
    alpha[at(candidates[j])] = 1.0;
    const auto velocities = fields.velocities(alpha, others);
    for (std::size_t i = 1; i < n; ++i) rates.rates[i * n + j] = -velocities[i - 1];
  }
  return rates;
}

/// x := a little later along the motion of a set (midpoint rule).
void Decider::step_ahead(const MeetingRegions& meeting, const switching::RegionSet& set, std::vector<double>& x) {
  const auto& candidates = meeting.candidates;
  const double time = look_ahead(switching_point_.time_scale);
  x.assign(switching_point_.x, switching_point_.x + s_.kernel.states());
  std::vector<double> f(x.size());
  switching::RegionSet own = set;
  for (const double fraction : {0.5, 1.0}) {
    std::vector<double> alpha = base_.alpha;
    for (const int region : candidates) alpha[at(region)] = 0.0;
    for (std::size_t k = 0; k < own.active.size(); ++k) alpha[at(candidates[at(own.active[k])])] = own.weights[k];
    s_.kernel.field(switching_point_.t + 0.5 * (fraction > 0.5 ? time : 0.0), x.data(), alpha.data(), f.data());
    for (std::size_t i = 0; i < x.size(); ++i) x[i] = switching_point_.x[i] + fraction * time * f[i];
    if (fraction < 1.0 && !solve_set(meeting, switching_point_.t + 0.5 * time, x.data(), set, own)) return;
  }
}

/// Whether a set that is admissible to rounding is so a little later along its own motion. What stays on the verge (an
/// equilibrium of one of the fields) is marked so, and as not attracting: it is the last to be taken.
bool Decider::goes_on(const MeetingRegions& meeting, switching::RegionSet& set) {
  constexpr double rounding = 1e-14;
  std::vector<double> ahead;
  step_ahead(meeting, set, ahead);
  switching::RegionSet later;
  if (!solve_set(meeting, switching_point_.t + look_ahead(switching_point_.time_scale), ahead.data(), set, later))
    return false;
  if (!(later.margin >= -rounding)) return false;
  if (later.margin <= rounding) {
    set.marginal = true;
    set.attracts = false;
  }
  return true;
}

/// The weights of a set at a point.
bool Decider::solve_set(const MeetingRegions& meeting, double t, const double* x, const switching::RegionSet& near,
                        switching::RegionSet& set) {
  if (meeting.basis) return switching::solve_region_face(tie_at(meeting, t, x), near.active, near.weights, set);
  return switching::solve_region_set(region_rates(meeting.candidates, t, x), near.active, set);
}

std::vector<switching::RegionSet> Decider::sets_that_go_on(const MeetingRegions& meeting) {
  auto admissible =
      meeting.basis
          ? switching::admissible_region_faces(tie_at(meeting, switching_point_.t, switching_point_.x), marginal_part)
          : switching::admissible_region_sets(region_rates(meeting.candidates, switching_point_.t, switching_point_.x),
                                              marginal_part);
  std::vector<switching::RegionSet> sets;
  for (auto& set : admissible) {
    if (meeting.basis && (is_lost(meeting, set) || !stays_tied(meeting, set))) continue;
    if (set.margin > marginal_part || goes_on(meeting, set)) sets.push_back(std::move(set));
  }
  switching::merge_same_motions(sets);
  return sets;
}

/// A kink, or a time, that is passed where regions meet: nothing slides on it.
bool Decider::passes(int surface) const {
  const auto role = s_.layout.surfaces[at(surface)].role;
  const bool is_beside = role == model::SwitchingRole::kink || role == model::SwitchingRole::time_event;
  return is_beside && !switching_point_.start && before_.mode[at(surface)] != 0;
}

/// The regions that meet there depend on its other side from here on.
void Decider::cross_beside(int surface) {
  const int mode = before_.mode[at(surface)];
  set_surface(base_, surface, -mode, mode > 0 ? 0.0 : 1.0);
  take({surface}, {-mode}, {mode > 0 ? 0.0 : 1.0});
}

namespace {

/// Of so many regions all sets are looked at.
constexpr std::size_t most_meeting = 12;

std::vector<int> with_reference(const ModeState& before, const evaluation::RegionRange& range,
                                const std::vector<int>& regions) {
  std::vector<int> all{reference_of(before, range)};
  all.insert(all.end(), regions.begin(), regions.end());
  return all;
}

}  // namespace

bool Decider::decide_regions(const std::vector<int>& group) {
  const auto& groups = s_.kernel.region_groups();
  const auto range = std::find_if(groups.begin(), groups.end(), [&](const auto& g) {
    return std::any_of(group.begin(), group.end(), [&](int j) { return g.holds(j); });
  });
  std::vector<int> regions, others;
  for (const int j : group) (range->holds(j) ? regions : others).push_back(j);
  const auto passed = std::stable_partition(others.begin(), others.end(), [&](int j) { return !passes(j); });
  for (auto j = passed; j != others.end(); ++j) cross_beside(*j);
  others.erase(passed, others.end());
  const bool too_many = regions.size() >= most_meeting || !s_.affine_in_alpha;
  if (!others.empty() || too_many) return decide_regions_with(others, *range, regions, group);
  return decide_regions_alone(meeting_of(with_reference(before_, *range, regions)), *range);
}

/// Regions that meet on other surfaces, too, or more than can be decided.
bool Decider::decide_regions_with(const std::vector<int>& others, const evaluation::RegionRange& range,
                                  const std::vector<int>& regions, const std::vector<int>& group) {
  const auto is_felt = [&, nested = nested_away_from_zero(s_.kernel, switching_point_)](int j) {
    return std::any_of(regions.begin(), regions.end(), [&](int i) { return depends_on(s_.kernel, nested, i, j); });
  };
  if (!others.empty() && std::none_of(others.begin(), others.end(), is_felt)) {
    auto parts = groups_of(s_.kernel, switching_point_, others);
    parts.insert(parts.begin(), regions);
    return decide_parts(parts);
  }
  const bool on_one = others.size() == 1 && regions.size() < most_meeting && s_.affine_in_alpha &&
                      s_.layout.surfaces[at(others[0])].role == model::SwitchingRole::listed;
  if (on_one) return decide_regions_on(others[0], range, with_reference(before_, range, regions));
  return fail(
      result::Termination::outside_class,
      fmt::format("at t = {} three or more regions by `indicator` meet on several other surfaces that influence "
                  "them ({}), or more than {} regions meet: that decision is not available; perturb a "
                  "parameter",
                  switching_point_.t, names(s_.layout, group), most_meeting));
}

/// Regions that meet, and no other surface: one of the sets that continue the solution.
bool Decider::decide_regions_alone(const MeetingRegions& meeting, const evaluation::RegionRange& range) {
  const auto& candidates = meeting.candidates;
  const auto sets = sets_that_go_on(meeting);
  if (sets.empty() && spiral_out(meeting, range)) return true;
  if (sets.empty() && meeting.basis &&
      switching::can_be_held(tie_at(meeting, switching_point_.t, switching_point_.x))) {
    return fail(result::Termination::outside_class,
                fmt::format("the regions {} meet at t = {}: some weights keep their indicators equal, but those that "
                            "follow the indicators come to rest nowhere, so that the weights are not determined",
                            names(s_.layout, candidates), switching_point_.t));
  }
  if (sets.empty()) {
    return fail(result::Termination::no_admissible_mode,
                fmt::format("the regions {} meet at t = {}, and no set of them continues the solution",
                            names(s_.layout, candidates), switching_point_.t));
  }
  const auto best = preferred_set(meeting, sets);
  RegionChoice choice{range, {active_of(candidates, sets[best])}, {}};
  std::vector<int> active;
  for (const auto& region : choice.sets.front()) active.push_back(region.region);
  const bool one_way = !meeting.basis || moves_in_one_way(meeting, sets[best]);
  choice.reason =
      fmt::format("{}: {} by Stewart's complementarity system{}", names(s_.layout, candidates),
                  names(s_.layout, active), one_way ? "" : ", which leaves weights open: those of soft minima");
  for (std::size_t k = 0; k < sets.size(); ++k) {
    if (k != best) choice.sets.push_back(active_of(candidates, sets[k]));
  }
  if (choice.sets.size() > 1 || !one_way) transition_.unique = false;
  group_reasons_.push_back(choice.reason);
  region_choices_.push_back(std::move(choice));
  return true;
}

/// The position of the set that goes on with the most of what was before.
std::size_t Decider::preferred_set(const MeetingRegions& meeting, const std::vector<switching::RegionSet>& sets) const {
  const auto& candidates = meeting.candidates;
  std::vector<int> before;
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    const auto j = candidates[k];
    if (!switching_point_.start && before_.mode[at(j)] == 0) before.push_back(static_cast<int>(k));
  }
  // Sets whose weights are not determined by linear equations have several of them: no jump to others where one ends.
  std::vector<double> weights;
  for (const int j : candidates) {
    if (meeting.basis && !switching_point_.start) weights.push_back(before_.alpha[at(j)]);
  }
  return switching::preferred_region_set(sets, before, weights);
}

void Decider::apply_regions() {
  for (const auto& choice : region_choices_) set_active(transition_.state, choice.group, choice.sets.front());
}

/// The other sets of regions that continue the solution, as alternatives.
void Decider::follow_other_regions() {
  for (const auto& choice : region_choices_) {
    for (std::size_t k = 1; k < choice.sets.size(); ++k) {
      ModeState other = transition_.state;
      set_active(other, choice.group, choice.sets[k]);
      if (!choice.surfaces.empty()) {
        const auto& [surface, mode, alpha] = choice.surfaces[k];
        set_surface(other, surface, mode, alpha);
      }
      Transition checked = check_forced_mode(s_, other, switching_point_);
      if (checked.termination != result::Termination::completed) continue;
      checked.reason = choice.reason;
      checked.unique = false;
      transition_.alternatives.push_back(std::move(checked));
    }
  }
}

}  // namespace saltus::event_integrator
