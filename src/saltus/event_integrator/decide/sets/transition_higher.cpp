// Higher-order sliding: where no rule decides and all surfaces involved can be held at zero, and where that ends.
#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "saltus/event_integrator/decide/transition_internal.hpp"
#include "saltus/event_integrator/field/higher_order.hpp"
#include "saltus/event_integrator/field/rooted_exit.hpp"
#include "saltus/event_integrator/mode/resolution.hpp"

namespace saltus::event_integrator {
namespace {

/// Regions around a higher-order set that are looked at for other continuations.
constexpr std::size_t most_regions = 16;

/// Leaves surfaces to the sides of a corner (bit i: the i-th of them), and reads those around them anew there.
void set_region(const SwitchingContext& s, const SwitchingPoint& switching_point, const std::vector<int>& surfaces,
                std::size_t corner, ModeState& state) {
  set_to_corner(state, surfaces, corner);
  const auto alpha = ProjectedFields(s.kernel, switching_point).corner_alpha(state.alpha, surfaces, corner);
  for (int j = 0; j < s.kernel.switching_functions(); ++j) {
    const double selection = alpha[at(j)];
    if (selection != state.alpha[at(j)]) set_surface(state, j, selection > 0.5 ? 1 : -1, selection);
  }
}

/// A state that leaves these surfaces to the sides of a corner, if its field agrees.
std::optional<Transition> leave_to(const SwitchingContext& s, ModeState state, const SwitchingPoint& switching_point,
                                   const std::vector<double>& x, const std::vector<int>& surfaces, std::size_t corner) {
  set_region(s, switching_point, surfaces, corner, state);
  int rooted = -1;
  if (!leads_into_its_region(s, state, switching_point, x, surfaces)) {
    // Explicit steps from a root overshoot.
    if (surfaces.size() != 1) return std::nullopt;
    RootedExit exit(s.kernel, s.affine_in_alpha, state, surfaces.front());
    if (!exit.leads_away(switching_point.t, x, look_ahead(switching_point.time_scale))) return std::nullopt;
    rooted = surfaces.front();
  }
  Transition transition = transition_to(std::move(state));
  transition.rooted = rooted;
  for (const int j : surfaces) transition.zero_order[at(j)] = 2;
  return transition;
}

/// The regions that meet at the set and that a solution can leave into.
void note_regions(const SwitchingContext& s, const SwitchingPoint& switching_point, const std::vector<double>& x,
                  Transition& transition) {
  const auto surfaces = transition.state.sliding;
  const std::size_t regions = std::size_t{1} << surfaces.size();
  if (regions > most_regions) {
    transition.unique = std::nullopt;
    return;
  }
  ModeState free = transition.state;
  free.higher.reset();
  for (std::size_t corner = 0; corner < regions; ++corner) {
    auto other = leave_to(s, free, switching_point, x, surfaces, corner);
    if (!other) continue;
    transition.unique = false;
    transition.alternatives.push_back(std::move(*other));
  }
}

/// Whether derivatives of psi are held, too.
bool leaves_derivative(const ModeState& before) {
  const auto& functions = before.higher->functions;
  return std::any_of(functions.begin(), functions.end(), [](const HeldFunction& f) { return f.order > 0; });
}

/// Whether surfaces are held whose gradients depend on each other: fewer functions than surfaces.
bool is_dependent(const ModeState& before) { return before.higher->functions.size() < before.sliding.size(); }

Transition failed(const SwitchingPoint& switching_point, const ModeState& before, const SwitchingContext& s,
                  const std::string& why) {
  Transition transition;
  transition.state = before;
  transition.termination = result::Termination::outside_class;
  transition.message = fmt::format("sliding on {} at t = {} ends, and what follows is not determined: {}",
                                   names(s.layout, before.sliding), switching_point.t, why);
  return transition;
}

/// Surfaces that are left, and to which sides: bit i belongs to the i-th of them.
struct Leaving {
  std::vector<int> surfaces;
  std::size_t corner = 0;
};

/// What a balance leaves whose range ends at 0 in some direction.
Leaving leaving_at(const ModeState& before, const BalanceRange& range, bool falls) {
  const auto& rows = before.higher->balances[range.balance].rows;
  const std::size_t free = falls ? range.free_above : range.free_below;
  const std::size_t corner = falls ? range.highest : range.lowest;
  Leaving leaving;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if ((free >> i & 1U) != 0) continue;
    leaving.corner |= (corner >> i & 1U) << leaving.surfaces.size();
    leaving.surfaces.push_back(before.sliding[rows[i]]);
  }
  return leaving;
}

/// Leaves some surfaces; the others are held on. nullopt if the field does not lead there.
std::optional<Transition> leave(const SwitchingContext& s, const ModeState& before,
                                const SwitchingPoint& switching_point, const std::vector<double>& x,
                                const Leaving& leaving, std::string& problem) {
  ModeState state = before;
  state.higher.reset();
  std::optional<Transition> left;
  if (leaving.surfaces.size() < before.sliding.size()) {
    set_region(s, switching_point, leaving.surfaces, leaving.corner, state);
    std::vector<double> point = x;
    left = hold(s, state, switching_point, point, problem);
    if (left && !leads_into_its_region(s, left->state, switching_point, point, leaving.surfaces)) left.reset();
    if (left) {
      for (const int j : leaving.surfaces) left->zero_order[at(j)] = 2;
    }
  } else {
    left = leave_to(s, state, switching_point, x, leaving.surfaces, leaving.corner);
  }
  if (left)
    left->reason = fmt::format("{}: no selection holds {} any more", names(s.layout, leaving.surfaces),
                               leaves_derivative(before) ? "a derivative at 0" : "them");
  return left;
}

/// One of the surfaces whose function has a root of another one; -1 if there is none.
int surface_around_root(const SwitchingContext& s, const std::vector<int>& surfaces) {
  for (const int j : surfaces) {
    const auto& inner = s.kernel.inner(j);
    const auto has_root_of = [&](int i) { return contains(inner, i) && s.kernel.has_root_inside(j, i); };
    if (std::any_of(surfaces.begin(), surfaces.end(), has_root_of)) return j;
  }
  return -1;
}

/// Whether functions are at zero together with others inside them.
bool nested_meet(const SwitchingContext& s, const SwitchingPoint& switching_point) {
  return std::any_of(switching_point.at_zero.begin(), switching_point.at_zero.end(), [&](int j) {
    const auto& inner = s.kernel.inner(j);
    return std::any_of(inner.begin(), inner.end(), [&](int i) { return contains(switching_point.at_zero, i); });
  });
}

/// The same where surfaces inside those that are left, or around them, are left with them: to the sides that the field
/// leads to.
std::optional<Transition> leave_with_nested(const SwitchingContext& s, const ModeState& before,
                                            const SwitchingPoint& switching_point, const std::vector<double>& x,
                                            const Leaving& leaving, std::string& problem) {
  const auto nested = [&](int i, int j) { return contains(s.kernel.inner(i), j) || contains(s.kernel.inner(j), i); };
  Leaving all = leaving;
  for (std::size_t k = 0; k < all.surfaces.size(); ++k) {
    for (const int j : before.sliding) {
      if (!contains(all.surfaces, j) && nested(all.surfaces[k], j)) all.surfaces.push_back(j);
    }
  }
  const std::size_t others = all.surfaces.size() - leaving.surfaces.size();
  if (others == 0 || (std::size_t{1} << others) > most_regions) return std::nullopt;
  for (std::size_t sides = 0; sides < std::size_t{1} << others; ++sides) {
    all.corner = leaving.corner | sides << leaving.surfaces.size();
    auto left = leave(s, before, switching_point, x, all, problem);
    if (!left) continue;
    if (left->rooted < 0) left->rooted = surface_around_root(s, all.surfaces);
    return left;
  }
  return std::nullopt;
}

/// Leaves through the corners of balances that can no longer be held; the others are held on. Where several directions
/// end at once: through all of them, else through one.
Transition leave_balances(const SwitchingContext& s, const ModeState& before, const SwitchingPoint& switching_point,
                          const std::vector<double>& x) {
  HigherOrderField field(s.kernel);
  field.enter(*before.higher, before.sliding, before.alpha);
  field.evaluate(switching_point.t, x.data());
  std::vector<Leaving> candidates;
  Leaving all;
  for (const auto& range : field.ranges()) {
    const int surface = before.sliding[range.row];
    const bool falls = contains(switching_point.exit_below, surface);
    if (!falls && !contains(switching_point.exit_above, surface)) continue;
    candidates.push_back(leaving_at(before, range, falls));
    const Leaving& own = candidates.back();
    for (std::size_t i = 0; i < own.surfaces.size(); ++i) {
      if (contains(all.surfaces, own.surfaces[i])) continue;
      all.corner |= (own.corner >> i & 1U) << all.surfaces.size();
      all.surfaces.push_back(own.surfaces[i]);
    }
  }
  if (candidates.size() > 1) candidates.insert(candidates.begin(), std::move(all));
  std::string problem = "its fields do not lead away from it";
  for (const Leaving& leaving : candidates) {
    if (auto left = leave(s, before, switching_point, x, leaving, problem)) return std::move(*left);
    if (auto left = leave_with_nested(s, before, switching_point, x, leaving, problem)) return std::move(*left);
  }
  return failed(switching_point, before, s, problem);
}

/// Where a set can be held at this moment only, to the accuracy of its balances, and not a little later: it is left. A
/// jump where sliding ends leaves the state there. nullopt if it is held, or no field leads away.
std::optional<Transition> leave_at_once(const SwitchingContext& s, const ModeState& held,
                                        const SwitchingPoint& switching_point, const std::vector<double>& x) {
  HigherOrderField field(s.kernel);
  field.enter(*held.higher, held.sliding, held.alpha);
  field.evaluate(switching_point.t, x.data());
  const auto now = field.ranges();
  const double h = look_ahead(switching_point.time_scale);
  std::vector<double> ahead = x;
  for (std::size_t i = 0; i < x.size(); ++i) ahead[i] += h * field.motion()[i];
  field.evaluate(switching_point.t + h, ahead.data());
  const auto& later = field.ranges();
  SwitchingPoint ends = switching_point;
  ends.exit_below.clear();
  ends.exit_above.clear();
  for (std::size_t k = 0; k < now.size() && k < later.size(); ++k) {
    const double rounding = velocity_accuracy * now[k].terms;
    const int surface = held.sliding[now[k].row];
    if (now[k].max <= rounding && later[k].max < -rounding) ends.exit_below.push_back(surface);
    if (now[k].min >= -rounding && later[k].min > rounding) ends.exit_above.push_back(surface);
  }
  if (ends.exit_below.empty() && ends.exit_above.empty()) return std::nullopt;
  auto left = leave_balances(s, held, ends, x);
  if (left.termination != result::Termination::completed) return std::nullopt;
  return left;
}

/// Surfaces whose gradients depend on each other are met or left.
Transition decide_about_dependent(const SwitchingContext& s, const ModeState& before,
                                  const SwitchingPoint& switching_point) {
  std::string problem;
  auto next = decide_dependent(s, before, switching_point, problem);
  if (!next) return failed(switching_point, before, s, problem);
  std::vector<int> left;
  for (const int j : before.sliding) {
    if (next->state.mode[at(j)] != 0) left.push_back(j);
  }
  if (!left.empty()) next->reason = fmt::format("{}: no selection holds them any more", names(s.layout, left));
  return std::move(*next);
}

/// A surface is crossed behind which no selections hold the set any more.
std::optional<Transition> cross_and_leave(const SwitchingContext& s, const ModeState& before,
                                          const SwitchingPoint& switching_point, const std::vector<double>& x,
                                          int surface) {
  ModeState behind = before;
  const int mode = before.mode[at(surface)];
  set_surface(behind, surface, -mode, mode > 0 ? 0.0 : 1.0);
  HigherOrderField field(s.kernel);
  field.enter(*behind.higher, behind.sliding, behind.alpha);
  field.evaluate(switching_point.t, x.data());
  SwitchingPoint ends = switching_point;
  ends.exit_below.clear();
  ends.exit_above.clear();
  for (const auto& range : field.ranges()) {
    const double rounding = velocity_accuracy * range.terms;
    if (range.max < -rounding) ends.exit_below.push_back(behind.sliding[range.row]);
    if (range.min > rounding) ends.exit_above.push_back(behind.sliding[range.row]);
  }
  if (ends.exit_below.empty() && ends.exit_above.empty()) return std::nullopt;
  auto left = leave_balances(s, behind, ends, x);
  if (left.termination != result::Termination::completed) return std::nullopt;
  if (!leads_into_its_region(s, left.state, switching_point, x, {surface})) return std::nullopt;
  left.zero_order[at(surface)] = 1;
  return left;
}

/// Another surface is met: crossed, or slid on as well.
Transition meet(const SwitchingContext& s, const ModeState& before, const SwitchingPoint& switching_point,
                const std::vector<double>& x, int surface) {
  const int mode = before.mode[at(surface)];
  ModeState behind = before;
  behind.higher.reset();
  std::string problem;
  set_surface(behind, surface, -mode, mode > 0 ? 0.0 : 1.0);
  std::vector<double> point = x;
  if (auto crossed = hold(s, behind, switching_point, point, problem)) {
    if (leads_into_its_region(s, crossed->state, switching_point, point, {surface})) {
      crossed->zero_order[at(surface)] = 1;
      crossed->reason = fmt::format("{}: crossed in higher-order sliding", s.layout.surfaces[at(surface)].name);
      return std::move(*crossed);
    }
  }
  if (auto left = cross_and_leave(s, before, switching_point, x, surface)) return std::move(*left);
  set_surface(behind, surface, 0, 0.5);
  point = x;
  if (auto joined = hold(s, behind, switching_point, point, problem)) return std::move(*joined);
  return failed(switching_point, before, s, problem);
}

}  // namespace

Transition transition_to(ModeState state) {
  Transition transition;
  for (auto& corner : state.corner_alpha) corner = state.alpha;
  set_corner_alpha(state);
  transition.zero_order.assign(state.mode.size(), 0);
  transition.state = std::move(state);
  return transition;
}

std::optional<Transition> hold(const SwitchingContext& s, ModeState state, const SwitchingPoint& switching_point,
                               std::vector<double>& x, std::string& problem) {
  // Behind a limit, everything that one of the last steps changes is at rest; elsewhere only what is rounding.
  const double resolved = (switching_point.limit ? 1.0 : 1e-9) * switching_point.time_scale;
  auto found = find_dependent_set(s, state, switching_point.t, x, problem);
  const bool dependent = found.has_value();
  if (!found && problem.empty()) found = find_higher_order_set(s, state, switching_point.t, x, resolved, problem);
  if (!found) return std::nullopt;
  const bool usual =
      found->undetermined.empty() && std::all_of(found->functions.begin(), found->functions.end(),
                                                 [](const HeldFunction& function) { return function.order == 0; });
  // Sliding of the usual kind is left to those who know it better.
  if (!usual) state.higher = std::make_shared<const HigherOrderSet>(std::move(*found));
  set_corner_alpha(state);
  ModeField field(s.kernel, s.affine_in_alpha);
  field.enter(state);
  std::vector<double> xdot(x.size());
  field(switching_point.t, x.data(), xdot.data());
  for (const int j : state.sliding) state.alpha[at(j)] = std::clamp(field.alpha()[at(j)], 0.0, 1.0);
  Transition transition = transition_to(std::move(state));
  transition.reason = fmt::format(
      "{}: {}", names(s.layout, transition.state.sliding),
      dependent
          ? "some selections in [0, 1] hold all of them, which depend on each other"
          : "some selections in [0, 1] hold what is at zero together with its derivatives (higher-order sliding)");
  return transition;
}

std::optional<Transition> hold_with_higher_order(const SwitchingContext& s, const ModeState& before,
                                                 const SwitchingPoint& switching_point) {
  ModeState state = before;
  state.higher.reset();
  for (const int j : switching_point.at_zero) set_surface(state, j, 0, 0.5);
  if (state.sliding != switching_point.at_zero) return std::nullopt;
  std::vector<double> x(switching_point.x, switching_point.x + s.kernel.states());
  std::string problem;
  auto transition = hold(s, std::move(state), switching_point, x, problem);
  if (!transition || !transition->state.higher) return std::nullopt;
  if (auto left = leave_at_once(s, transition->state, switching_point, x)) return left;
  note_regions(s, switching_point, x, *transition);
  return transition;
}

std::optional<Transition> rest_where_nested_meet(const SwitchingContext& s, const ModeState& before,
                                                 const SwitchingPoint& switching_point) {
  if (!nested_meet(s, switching_point)) return std::nullopt;
  return hold_with_higher_order(s, before, switching_point);
}

std::optional<Transition> leave_where_nested_meet(const SwitchingContext& s, const ModeState& before,
                                                  const SwitchingPoint& switching_point) {
  const auto& surfaces = switching_point.at_zero;
  if (!nested_meet(s, switching_point) ||
      (std::size_t{1} << std::min<std::size_t>(surfaces.size(), 8)) > most_regions) {
    return std::nullopt;
  }
  ModeState state = before;
  state.higher.reset();
  const std::vector<double> x(switching_point.x, switching_point.x + s.kernel.states());
  std::optional<Transition> found;
  for (std::size_t corner = 0; corner < std::size_t{1} << surfaces.size(); ++corner) {
    auto left = leave_to(s, state, switching_point, x, surfaces, corner);
    if (!left) continue;
    if (left->rooted < 0) left->rooted = surface_around_root(s, surfaces);
    left->reason =
        fmt::format("{}: no selection holds them; the field of these regions leads away", names(s.layout, surfaces));
    if (found) {
      found->unique = false;
      found->alternatives.push_back(std::move(*left));
    } else {
      found = std::move(left);
    }
  }
  return found;
}

Transition decide_from_higher_order(const SwitchingContext& s, const ModeState& before,
                                    const SwitchingPoint& switching_point) {
  const std::vector<double> x(switching_point.x, switching_point.x + s.kernel.states());
  std::vector<int> met, exits = switching_point.exit_below;
  exits.insert(exits.end(), switching_point.exit_above.begin(), switching_point.exit_above.end());
  for (const int j : switching_point.touched) {
    if (!contains(before.sliding, j)) met.push_back(j);
  }
  if (is_dependent(before)) {
    if (!met.empty() || !exits.empty()) return decide_about_dependent(s, before, switching_point);
  }
  if (met.size() > 1 || (!met.empty() && !exits.empty())) {
    return failed(switching_point, before, s, "several things happen at once");
  }
  if (met.size() == 1) return meet(s, before, switching_point, x, met.front());
  if (!exits.empty()) return leave_balances(s, before, switching_point, x);
  ModeState state = before;
  state.higher.reset();
  std::vector<double> point = x;
  std::string problem;
  auto held = is_dependent(before) ? hold_dependent(s, state, switching_point, point, problem)
                                   : hold(s, state, switching_point, point, problem);
  return held ? std::move(*held) : failed(switching_point, before, s, problem);
}

}  // namespace saltus::event_integrator
