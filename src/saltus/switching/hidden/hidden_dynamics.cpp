#include "saltus/switching/hidden/hidden_dynamics.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <utility>

#include "saltus/base/at.hpp"
#include "saltus/base/components.hpp"
#include "saltus/base/contains.hpp"
#include "saltus/base/contracts.hpp"
#include "saltus/switching/hidden/hidden_face_internal.hpp"
#include "saltus/switching/hidden/hidden_trajectory_internal.hpp"
#include "saltus/switching/table/field_accuracy.hpp"

namespace saltus::switching {
namespace {

/// A point without special position: differences of a multi-affine function there vanish only if it does not depend on
/// the selection.
double generic(int j) { return 0.3 + 0.4 * std::fmod(0.618033988749895 * (j + 1), 1.0); }

/// Connected groups of surfaces that depend on each other, each ascending.
std::vector<std::vector<int>> groups_of(int surfaces, ProjectedField g) {
  const std::size_t m = at(surfaces);
  Components components(m);
  std::vector<double> alpha(m);
  for (int j = 0; j < surfaces; ++j) alpha[at(j)] = generic(j);
  std::vector<double> here(m);
  std::vector<double> there(m);
  g(alpha.data(), here.data());
  for (int p = 0; p < surfaces; ++p) {
    const double before = alpha[at(p)];
    alpha[at(p)] = before < 0.5 ? 1.0 : 0.0;  // far, for smooth g too: only whether it matters is asked
    g(alpha.data(), there.data());
    alpha[at(p)] = before;
    for (int j = 0; j < surfaces; ++j) {
      const double size = std::max(std::abs(here[at(j)]), std::abs(there[at(j)]));
      if (std::abs(there[at(j)] - here[at(j)]) > field_rounding * size) components.join(at(j), at(p));
    }
  }
  std::vector<std::vector<int>> groups;
  for (const auto& component : components.lists()) groups.emplace_back(component.begin(), component.end());
  return groups;
}

/// The starts of the hidden dynamics for a situation, the one that decides first.
std::vector<std::vector<double>> starts_of(const HiddenSituation& situation) {
  const std::size_t m = situation.arrival.size();
  std::vector<double> u(m);
  std::vector<std::size_t> arriving;
  std::vector<std::size_t> starting;
  for (std::size_t j = 0; j < m; ++j) {
    switch (situation.arrival[j]) {
      case Arrival::from_below:
        arriving.push_back(j);
        u[j] = 0.0;
        break;
      case Arrival::from_above:
        arriving.push_back(j);
        u[j] = 1.0;
        break;
      case Arrival::along:
        u[j] = situation.alpha[j];
        break;
      case Arrival::at_start:
        starting.push_back(j);
        u[j] = 1.0;
        break;
    }
  }
  std::vector<std::vector<double>> starts{u};
  // One surface ahead of the others: so far that they do not depend on each other's layers.
  constexpr double ahead = 1e3;
  if (arriving.size() > 1) {
    for (const std::size_t first : arriving) {
      starts.push_back(u);
      for (const std::size_t j : arriving) {
        if (j != first) starts.back()[j] += u[j] > 0.5 ? ahead : -ahead;
      }
    }
  }
  // From the other corners, one selection or all of them different: m + 1 of the 2^m.
  for (const std::size_t j : starting) {
    starts.push_back(u);
    starts.back()[j] = 0.0;
  }
  if (starting.size() > 1) {
    starts.push_back(u);
    for (const std::size_t j : starting) starts.back()[j] = 0.0;
  }
  return starts;
}

/// What a group of surfaces does, as part of the decision about all.
void merge(const std::vector<int>& group, const HiddenDecision& part, HiddenDecision& whole) {
  const auto rank = [](HiddenLimit limit) { return static_cast<int>(limit); };
  if (rank(part.limit) > rank(whole.limit) || whole.reason.empty()) {
    whole.limit = std::max(part.limit, whole.limit, [&](auto a, auto b) { return rank(a) < rank(b); });
    whole.reason = part.reason;
  }
  whole.structurally_unstable = whole.structurally_unstable || part.structurally_unstable;
  whole.evaluations += part.evaluations;
  for (std::size_t i = 0; i < group.size(); ++i) {
    whole.mode[at(group[i])] = part.mode[i];
    whole.alpha[at(group[i])] = part.alpha[i];
  }
}

/// Other modes of one group in the modes of all surfaces.
void merge_alternatives(const std::vector<int>& group, const HiddenDecision& part, HiddenDecision& whole) {
  for (const auto& modes : part.other_modes) {
    whole.other_modes.push_back(whole.mode);
    for (std::size_t i = 0; i < group.size(); ++i) whole.other_modes.back()[at(group[i])] = modes[i];
  }
}

HiddenSituation part_of(const HiddenSituation& situation, const std::vector<int>& group) {
  HiddenSituation part;
  for (const int j : group) {
    part.arrival.push_back(situation.arrival[at(j)]);
    part.alpha.push_back(situation.alpha.empty() ? 0.5 : situation.alpha[at(j)]);
  }
  return part;
}

HiddenOptions part_of(const HiddenOptions& options, const std::vector<int>& group) {
  HiddenOptions part = options;
  part.scaling.clear();
  if (options.scaling.empty()) return part;
  for (const int j : group) part.scaling.push_back(options.scaling[at(j)]);
  return part;
}

/// Splits into groups, decides each by `decide_group(group, its situation, its options)`, and puts the parts together.
template <class Decide>
HiddenDecision decide_in_groups(int surfaces, ProjectedField g, const HiddenSituation& situation,
                                const HiddenOptions& options, Decide&& decide_group) {
  SALTUS_ASSERT(surfaces >= 1 && situation.arrival.size() == at(surfaces));
  SALTUS_ASSERT(options.scaling.empty() || options.scaling.size() == at(surfaces));
  HiddenDecision whole;
  whole.limit = HiddenLimit::settled;
  whole.mode.resize(at(surfaces));
  whole.alpha.resize(at(surfaces));
  const auto groups = groups_of(surfaces, g);
  whole.evaluations = surfaces + 1;
  std::vector<HiddenDecision> parts;
  for (const auto& group : groups) {
    parts.push_back(decide_group(group, part_of(situation, group), part_of(options, group)));
    merge(group, parts.back(), whole);
  }
  for (std::size_t i = 0; i < groups.size(); ++i) merge_alternatives(groups[i], parts[i], whole);
  return whole;
}

/// g of a group, the selections of the others held: it does not depend on them.
class GroupField {
 public:
  GroupField(int surfaces, ProjectedField g, const std::vector<int>& group)
      : g_(g), group_(group), alpha_(at(surfaces), 0.5), velocity_(at(surfaces)) {}

  void operator()(const double* alpha, double* g) {
    for (std::size_t i = 0; i < group_.size(); ++i) alpha_[at(group_[i])] = alpha[i];
    g_(alpha_.data(), velocity_.data());
    for (std::size_t i = 0; i < group_.size(); ++i) g[i] = velocity_[at(group_[i])];
  }

 private:
  ProjectedField g_;
  const std::vector<int>& group_;
  std::vector<double> alpha_, velocity_;
};

/// Adds the end of one more trajectory: the first decides, later ones are compared with it.
void add(const TrajectoryEnd& end, HiddenDecision& decision) {
  const bool first = decision.reason.empty();
  if (first || (decision.limit == HiddenLimit::undecided && end.limit != HiddenLimit::undecided)) {
    decision.limit = end.limit;
    decision.mode = end.mode;
    decision.alpha = end.alpha;
    decision.reason = end.reason;
    decision.structurally_unstable = end.marginal || !first;
    return;
  }
  const bool same = end.limit == decision.limit ||
                    (end.limit <= HiddenLimit::oscillating && decision.limit <= HiddenLimit::oscillating);
  if (same && end.mode == decision.mode) return;
  decision.structurally_unstable = true;
  if (end.limit > HiddenLimit::oscillating) return;
  auto& others = decision.other_modes;
  if (!contains(others, end.mode)) others.push_back(end.mode);
}

TrajectoryOptions trajectory_options(const HiddenOptions& options, double tolerance, double tolerance_away) {
  return {options.budget, tolerance, tolerance_away, options.interpolation == Interpolation::multi_affine,
          ode::Method::dopri5};
}

}  // namespace

HiddenDecision decide_by_hidden_dynamics(int surfaces, ProjectedField g, const HiddenSituation& situation,
                                         const HiddenOptions& options) {
  constexpr double tolerance = 1e-9;
  constexpr double tolerance_away = tolerance;
  const auto decide_group = [&](const auto& group, const HiddenSituation& own, const HiddenOptions& own_options) {
    GroupField field(surfaces, g, group);
    HiddenFace face(static_cast<int>(group.size()), field, options.interpolation);
    face.set_scaling(own_options.scaling);
    HiddenTrajectory trajectory(face, trajectory_options(own_options, tolerance, tolerance_away));
    HiddenDecision decision;
    for (const auto& start : starts_of(own)) {
      const TrajectoryEnd end = trajectory.follow(start);
      add(end, decision);
      decision.structurally_unstable = decision.structurally_unstable || end.nudged;
    }
    decision.evaluations = face.evaluations();
    return decision;
  };
  return decide_in_groups(surfaces, g, situation, options, decide_group);
}

HiddenDecision decide_by_hidden_dynamics(const CornerTable& table, const HiddenSituation& situation,
                                         const HiddenOptions& options) {
  const MultiAffine g(table);
  return decide_by_hidden_dynamics(
      table.surfaces, [&](const double* alpha, double* velocity) { g.evaluate(alpha, velocity); }, situation, options);
}

HiddenDecision decide_leaving(int surfaces, ProjectedField g, ProjectedField rate, const HiddenSituation& situation,
                              double eta, const HiddenOptions& options) {
  // Far below eta, which is all that the solution gets away from the root by; and of nudges.
  constexpr double tolerance = 1e-10;
  constexpr double tolerance_nudged = 1e-6;
  constexpr double tolerance_away = 1e-7;
  constexpr std::array nudges{2e-3, -2e-3, 1.2e-3, -1.2e-3};  // on different turns of a spiral; linear to that
  std::vector<double> velocity(at(surfaces));
  double after = eta;
  const auto later = [&](const double* alpha, double* result) {
    g(alpha, result);
    rate(alpha, velocity.data());
    for (int j = 0; j < surfaces; ++j) result[j] += after * velocity[at(j)];
  };
  const auto decide_group = [&](const auto& group, const HiddenSituation& own, const HiddenOptions& own_options) {
    HiddenDecision decision;
    for (const double fraction : {1.0, 0.01}) {
      after = eta * fraction;
      GroupField field(surfaces, later, group);
      HiddenFace face(static_cast<int>(group.size()), field, options.interpolation);
      face.set_scaling(own_options.scaling);
      TrajectoryOptions closely =
          trajectory_options(own_options, fraction < 1.0 ? 0.1 * tolerance : tolerance, tolerance_away);
      closely.method = ode::Method::dop853;  // long turns at tight tolerances
      HiddenTrajectory trajectory(face, closely);
      for (const auto& start : starts_of(own)) {
        const TrajectoryEnd end = trajectory.follow(start);
        add(end, decision);
        if (!trajectory.rests_near(start)) {
          decision.structurally_unstable = decision.structurally_unstable || end.nudged;
          continue;
        }
        if (fraction < 1.0) continue;
        // The root is still there, but no longer stable: which way it is left is not the event's to say.
        TrajectoryOptions fewer = closely;
        fewer.tolerance = fewer.tolerance_away = tolerance_nudged;
        fewer.budget /= 10;
        HiddenTrajectory nudged(face, fewer);
        for (std::size_t j = 0; j < start.size(); ++j) {
          for (const double nudge : nudges) {
            auto moved = start;
            moved[j] += nudge;
            const TrajectoryEnd other = nudged.follow(moved);
            if (other.limit != HiddenLimit::undecided) add(other, decision);
          }
        }
      }
      decision.evaluations += face.evaluations();
    }
    after = eta;
    return decision;
  };
  return decide_in_groups(surfaces, later, situation, options, decide_group);
}

}  // namespace saltus::switching
