// Many surfaces of which each depends on few others: part after part, in the order of influence. That is no problem of
// switching/point: velocities are multi-affine in the selections, of which there may be a thousand. Where a comparison
// matrix certifies that one balance attracts, sparse Newton steps that keep to the bounds find it.
#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "saltus/event_integrator/decide/transition_internal.hpp"
#include "saltus/event_integrator/field/large_group.hpp"
#include "saltus/switching/sparse/attraction.hpp"

namespace saltus::event_integrator {
namespace {

using switching::SurfaceDecision;
using switching::Verdict;

/// The point at which parts are decided is that of the event. Where selections have reached their bounds it is a little
/// later along the sliding that ends, as no field moves away at the event itself.
struct LaterPoint {
  SwitchingPoint switching_point;
  std::vector<double> x;
};

LaterPoint point_to_decide(const SwitchingContext& s, const ModeState& before, const SwitchingPoint& switching_point) {
  LaterPoint later{switching_point, {}};
  if (switching_point.start || (switching_point.exit_below.empty() && switching_point.exit_above.empty())) return later;
  ModeField field(s.kernel, s.affine_in_alpha);
  field.enter(before);
  later.x.resize(at(s.kernel.states()));
  field(switching_point.t, switching_point.x, later.x.data());
  const double time = 1e-4 * switching_point.time_scale;
  for (std::size_t i = 0; i < later.x.size(); ++i) later.x[i] = switching_point.x[i] + time * later.x[i];
  later.switching_point.t += time;
  later.switching_point.exit_below.clear();
  later.switching_point.exit_above.clear();
  return later;
}

/// Decides the parts of one group at one point.
class PartDecider {
 public:
  PartDecider(const SwitchingContext& s, const ModeState& before, const ModeState& base,
              const SwitchingPoint& switching_point, const ProjectedFields& fields)
      : s_(s),
        before_(before),
        base_(base),
        switching_point_(switching_point),
        fields_(fields),
        moved_(before.mode.size(), false) {}

  [[nodiscard]] ModeState& base() { return base_; }
  [[nodiscard]] const std::string& problem() const { return problem_; }

  /// Whether a part has to be decided at all.
  [[nodiscard]] bool is_touched(const std::vector<int>& part, const switching::Influence& depends_on,
                                const std::vector<int>& group, const std::vector<int>& touched) const {
    return switching_point_.start || std::any_of(part.begin(), part.end(), [&](int k) {
             const auto& felt = depends_on[at(k)];
             return contains(touched, group[at(k)]) ||
                    std::any_of(felt.begin(), felt.end(), [&](int i) { return moved_[at(group[at(i)])]; });
           });
  }

  void note(std::span<const std::pair<int, SurfaceDecision>> decisions) {
    for (const auto& [surface, decision] : decisions) {
      const double before = std::clamp(before_.alpha[at(surface)], 0.0, 1.0);
      // Selections are carried along to about 1e-8.
      moved_[at(surface)] = switching_point_.start || decision.mode != before_.mode[at(surface)] ||
                            std::abs(decision.alpha - before) > 1e-7;
      set_surface(base_, surface, decision.mode, decision.alpha);
    }
  }

  /// One surface that depends on nobody later. Behind a transient of those it depends on, only what has no choice is
  /// decided.
  std::optional<SurfaceDecision> decide_one(int surface, bool behind_transient, double& scale) {
    const auto table = fields_.table(base_, {surface});
    scale = std::max(std::abs(table.side(0, 0).velocity), std::abs(table.side(0, 1).velocity));
    auto decision = switching::decide_surface({table.side(0, 0), table.side(0, 1), table.arrival[0]});
    const auto& name = s_.layout.surfaces[at(surface)].name;
    if (decision.verdict != Verdict::decided) {
      problem_ = fmt::format("the fields beside '{}' are tangent to it", name);
      return std::nullopt;
    }
    if (behind_transient && !decision.other_modes.empty()) {
      problem_ = fmt::format(
          "the fields beside '{}' point away from it once the surfaces that it depends on have changed, "
          "so that their transient would decide",
          name);
      return std::nullopt;
    }
    return decision;
  }

  /// Several that depend on each other, if each of them depends on itself more than the others.
  std::optional<switching::BoundedRoot> decide_several(const switching::Influence& depends_on,
                                                       const std::vector<int>& surfaces, std::vector<double>& scale) {
    std::vector<double> alpha = base_.alpha;
    for (const int j : surfaces) scale[at(j)] = 0.0;
    const auto velocities = [&](const double* selections, double* g) {
      for (std::size_t k = 0; k < surfaces.size(); ++k) alpha[at(surfaces[k])] = selections[k];
      const auto values = fields_.velocities(alpha, surfaces);
      for (std::size_t k = 0; k < surfaces.size(); ++k) {
        g[k] = values[k];
        scale[at(surfaces[k])] = std::max(scale[at(surfaces[k])], std::abs(g[k]));
      }
    };
    const auto comparison = switching::comparison_in_cube(depends_on, velocities);
    if (comparison) {
      std::vector<double> start;
      for (const int j : surfaces) start.push_back(std::clamp(base_.alpha[at(j)], 0.0, 1.0));
      const auto root = switching::bounded_root(depends_on, velocities, *comparison, start);
      if (root && !root->is_borderline) return root;
    }
    problem_ = fmt::format(
        "{} of them depend on each other, more than themselves or tangent to one: {}", surfaces.size(),
        names(s_.layout, {surfaces.begin(), surfaces.begin() + std::min<std::ptrdiff_t>(3, std::ssize(surfaces))}) +
            ", …");
    return std::nullopt;
  }

 private:
  const SwitchingContext& s_;
  const ModeState& before_;
  ModeState base_;
  const SwitchingPoint& switching_point_;
  const ProjectedFields& fields_;
  std::vector<bool> moved_;  ///< by surface: its selection is another one than before
  std::string problem_;
};

SurfaceDecision decision_of(const switching::BoundedRoot& root, std::size_t k) {
  return {
      Verdict::decided, root.mode[k], root.alpha[k], {}, "the only balance of the surfaces that influence each other"};
}

/// Of the surfaces of a group, by their places in it.
switching::Influence influence_in(const evaluation::ModelKernel& kernel, const std::vector<int>& group) {
  switching::Influence depends_on(group.size());
  for (std::size_t i = 0; i < group.size(); ++i) {
    for (const int j : kernel.neighbours(group[i])) {
      const auto place = std::lower_bound(group.begin(), group.end(), j);
      if (place == group.end() || *place != j || !kernel.depends(group[i], j)) continue;
      depends_on[i].push_back(static_cast<int>(place - group.begin()));
    }
  }
  return depends_on;
}

/// The surfaces that are touched and all that depend on them, directly or through others: places in the group,
/// ascending.
std::vector<int> affected_by(const std::vector<int>& touched, const switching::Influence& depends_on,
                             const std::vector<int>& group) {
  std::vector<std::vector<int>> felt_by(depends_on.size());
  for (std::size_t i = 0; i < depends_on.size(); ++i) {
    for (const int j : depends_on[i]) felt_by[at(j)].push_back(static_cast<int>(i));
  }
  std::vector<bool> is_affected(depends_on.size(), false);
  std::vector<int> open;
  const auto affect = [&](int k) {
    if (is_affected[at(k)]) return;
    is_affected[at(k)] = true;
    open.push_back(k);
  };
  for (const int j : touched) {
    const auto place = std::lower_bound(group.begin(), group.end(), j);
    if (place != group.end() && *place == j) affect(static_cast<int>(place - group.begin()));
  }
  std::vector<int> affected;
  while (!open.empty()) {
    const int k = open.back();
    open.pop_back();
    affected.push_back(k);
    for (const int i : felt_by[at(k)]) affect(i);
  }
  std::sort(affected.begin(), affected.end());
  return affected;
}

std::vector<int> members(const std::vector<int>& group, const std::vector<int>& places) {
  std::vector<int> surfaces;
  for (const int k : places) surfaces.push_back(group[at(k)]);
  return surfaces;
}

}  // namespace

bool Decider::has_lost_root() const {
  return !switching_point_.coalesced.empty() || !switching_point_.destabilised.empty() ||
         !switching_point_.tied.empty();
}

/// Nothing where a group is not large, or where a part of it is not decided: `undecided_part_` says which. Parts of up
/// to four surfaces are decided by their tables as if they were alone.
std::optional<bool> Decider::decide_large(const std::vector<int>& group) {
  undecided_part_.clear();
  if (!is_large(group.size()) || !s_.affine_in_alpha) return std::nullopt;
  if (has_lost_root() || !nested_away_from_zero(s_.kernel, switching_point_).empty()) {
    undecided_part_ = "their root has ended, or functions are nested around them";
    return std::nullopt;
  }
  const auto depends_on = influence_in(s_.kernel, group);
  LaterPoint point = point_to_decide(s_, before_, switching_point_);
  if (!point.x.empty()) point.switching_point.x = point.x.data();
  const ProjectedFields fields(s_.kernel, point.switching_point);
  PartDecider parts(s_, before_, base_, point.switching_point, fields);
  const std::size_t decided_before = decisions_.size();
  const auto give_up = [&]() -> std::optional<bool> {
    decisions_.resize(decided_before);
    undecided_part_ = parts.problem();
    return std::nullopt;
  };
  const auto note_from = [&](std::size_t first) { parts.note(std::span(decisions_).subspan(first)); };
  const auto decide_at_once = [&](const std::vector<int>& places) {
    const std::vector<int> surfaces = members(group, places);
    const auto root = parts.decide_several(switching::restricted_to(depends_on, places), surfaces, scale_);
    if (!root) return false;
    const std::size_t first = decisions_.size();
    for (std::size_t k = 0; k < surfaces.size(); ++k) decisions_.emplace_back(surfaces[k], decision_of(*root, k));
    note_from(first);
    return true;
  };
  // The certificate holds for one-way influence, too, and costs no more for many surfaces than for few.
  const auto affected = affected_by(switching_point_.start ? group : switching_point_.touched, depends_on, group);
  if (is_large(affected.size()) && decide_at_once(affected)) return true;
  for (const auto& part : switching::ordered_parts(depends_on)) {
    if (!parts.is_touched(part, depends_on, group, switching_point_.touched)) continue;
    const std::vector<int> surfaces = members(group, part);
    if (surfaces.size() == 1) {
      const int j = surfaces.front();
      const bool behind = !depends_on[at(part.front())].empty() && parts.is_touched(part, depends_on, group, {});
      const auto decision = parts.decide_one(j, behind, scale_[at(j)]);
      if (!decision) return give_up();
      decisions_.emplace_back(j, *decision);
      note_from(decisions_.size() - 1);
      continue;
    }
    if (decide_at_once(part)) continue;
    // By the tables of all corners, where these are not too many; not where that has been tried for the group anyway.
    constexpr std::size_t largest_table = 12;
    if (group.size() <= largest_table || surfaces.size() > largest_table) return give_up();
    const std::size_t first = decisions_.size();
    std::swap(base_, parts.base());
    const bool decided = decide(surfaces);
    std::swap(base_, parts.base());
    if (!decided) return false;
    note_from(first);
  }
  return true;
}

}  // namespace saltus::event_integrator
