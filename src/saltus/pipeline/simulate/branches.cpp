#include <algorithm>
#include <cstddef>
#include <deque>
#include <utility>

#include "saltus/pipeline/simulate/branches_internal.hpp"

namespace saltus::pipeline {
namespace {

/// A branch that is known and not followed yet.
struct Waiting {
  Path path;
  std::size_t parent = 0;
  result::Departure left_at;
};

/// Adds members of the families of trajectory `number`.
void find_members(const Followed& trajectory, const Path& path, std::size_t number, long members,
                  std::deque<Waiting>& waiting) {
  for (std::size_t f = 0; f < trajectory.result.families.size(); ++f) {
    const auto& family = trajectory.result.families[f];
    const bool spiral = family.kind == result::FamilyKind::spiral;
    for (long i = 1; i <= members; ++i) {
      const double part = static_cast<double>(i) / static_cast<double>(members + 1);
      event_integrator::Choice choice{trajectory.family_numbers[f]};
      double parameter = part;
      if (spiral) {
        choice.phase = part;
      } else {
        choice.leave_at = parameter = family.from + part * (family.until - family.from);
      }
      Path longer = path;
      longer.push_back(choice);
      waiting.push_back({std::move(longer), number, {family.event, 0, result::FamilyMember{f, parameter}}});
    }
  }
}

/// Adds what leaves trajectory `number`.
void find_branches(const Followed& trajectory, const Path& path, std::size_t number, std::deque<Waiting>& waiting) {
  for (const auto& point : trajectory.branch_points) {
    const auto& event = trajectory.result.events[point.event];
    for (std::size_t alternative = 0; alternative < event.alternatives.size(); ++alternative) {
      Path longer = path;
      longer.push_back({point.decision, alternative});
      waiting.push_back({std::move(longer), number, {point.event, alternative, {}}});
    }
  }
}

/// Puts every trajectory under its parent; parents come before their branches.
result::Result nested(std::vector<result::Result> trajectories, const std::vector<std::size_t>& parents) {
  for (std::size_t i = trajectories.size(); i-- > 1;) {
    auto& siblings = trajectories[parents[i]].branches;
    siblings.insert(siblings.begin(), std::move(trajectories[i]));
  }
  return std::move(trajectories.front());
}

}  // namespace

result::Result follow_branches(FunctionRef<Followed(const Path&, const Count&)> run, const Follow& follow) {
  const long most = follow.trajectories;
  std::vector<result::Result> trajectories;
  std::vector<std::size_t> parents;
  std::deque<Waiting> waiting{{}};
  bool stopped = false;
  while (!waiting.empty() && !stopped && static_cast<long>(trajectories.size()) < most) {
    const Waiting next = std::move(waiting.front());
    waiting.pop_front();
    const auto number = trajectories.size();
    const auto known = static_cast<long>(number + 1 + waiting.size());
    Followed followed = run(next.path, {static_cast<long>(number + 1), std::min(known, most)});
    stopped = followed.result.status.termination == result::Termination::stopped_by_user;
    if (!followed.reached) continue;
    find_branches(followed, next.path, number, waiting);
    find_members(followed, next.path, number, follow.members, waiting);
    if (!next.path.empty()) followed.result.left_at = next.left_at;
    trajectories.push_back(std::move(followed.result));
    parents.push_back(next.parent);
  }
  return nested(std::move(trajectories), parents);
}

}  // namespace saltus::pipeline
