// Higher-order sliding: where no rule decides and all surfaces involved can be held at zero, and where that ends.
#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "saltus/event_integrator/higher_order.hpp"
#include "saltus/event_integrator/rooted_exit.hpp"
#include "saltus/event_integrator/transition_internal.hpp"

namespace saltus::event_integrator {
namespace {

/// Regions around a higher-order set that are looked at for other continuations.
constexpr std::size_t most_regions = 16;

/// Whether x moves from a common zero of these surfaces into the region of `state` along its own field: no derivative
/// of psi decides alone where several vanish together. By Runge-Kutta steps over a hundredth of the time scale.
bool leads_into_its_region(const Surroundings& s, const ModeState& state, const Occasion& occasion,
                           const std::vector<double>& start, const std::vector<int>& surfaces) {
  ModeField field(s.kernel, s.affine_in_alpha);
  field.enter(state);
  const std::size_t n = start.size();
  std::vector<double> x = start, trial(n), k1(n), k2(n), k3(n), k4(n), psi(at(s.kernel.event_functions()));
  constexpr int steps = 4;
  const double h = 1e-2 * occasion.time_scale / steps;
  double t = occasion.t;
  const auto stage = [&](double part, const std::vector<double>& slope, std::vector<double>& result) {
    for (std::size_t i = 0; i < n; ++i) trial[i] = x[i] + part * h * slope[i];
    field(t + part * h, trial.data(), result.data());
  };
  for (int step = 0; step < steps; ++step) {
    field(t, x.data(), k1.data());
    stage(0.5, k1, k2);
    stage(0.5, k2, k3);
    stage(1.0, k3, k4);
    for (std::size_t i = 0; i < n; ++i) x[i] += h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]);
    t += h;
    s.kernel.functions(t, x.data(), state.alpha.data(), psi.data());
    for (const int j : surfaces) {
      if (!(psi[at(j)] * state.mode[at(j)] > 0.0)) return false;
    }
  }
  return true;
}

Transition transition_to(ModeState state) {
  Transition transition;
  for (auto& corner : state.corner_alpha) corner = state.alpha;
  set_corner_alpha(state);
  transition.zero_order.assign(state.mode.size(), 0);
  transition.state = std::move(state);
  return transition;
}

/// A state that leaves these surfaces to the sides of a corner (bit i: the i-th of them), if its field agrees.
std::optional<Transition> leave_to(const Surroundings& s, ModeState state, const Occasion& occasion,
                                   const std::vector<double>& x, const std::vector<int>& surfaces, std::size_t corner) {
  set_to_corner(state, surfaces, corner);
  int rooted = -1;
  if (!leads_into_its_region(s, state, occasion, x, surfaces)) {
    // Explicit steps from a root overshoot.
    if (surfaces.size() != 1) return std::nullopt;
    RootedExit exit(s.kernel, s.affine_in_alpha, state, surfaces.front());
    if (!exit.leads_away(occasion.t, x, 1e-2 * occasion.time_scale)) return std::nullopt;
    rooted = surfaces.front();
  }
  Transition transition = transition_to(std::move(state));
  transition.rooted = rooted;
  for (const int j : surfaces) transition.zero_order[at(j)] = 2;
  return transition;
}

/// The state with all its sliding surfaces held with higher order; nullopt where they cannot be.
std::optional<Transition> hold(const Surroundings& s, ModeState state, const Occasion& occasion, std::vector<double>& x,
                               std::string& problem) {
  // Behind a limit, everything that one of the last steps changes is at rest; elsewhere only what is rounding.
  const double resolved = (occasion.limit ? 1.0 : 1e-9) * occasion.time_scale;
  auto found = find_higher_order_set(s, state, occasion.t, x, resolved, problem);
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
  field(occasion.t, x.data(), xdot.data());
  for (const int j : state.sliding) state.alpha[at(j)] = std::clamp(field.alpha()[at(j)], 0.0, 1.0);
  Transition transition = transition_to(std::move(state));
  transition.reason = fmt::format(
      "{}: some selections in [0, 1] hold what is at zero together with its derivatives "
      "(higher-order sliding)",
      names(s.system, transition.state.sliding));
  return transition;
}

/// The regions that meet at the set and that a solution can leave into.
void note_regions(const Surroundings& s, const Occasion& occasion, const std::vector<double>& x,
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
    auto other = leave_to(s, free, occasion, x, surfaces, corner);
    if (!other) continue;
    transition.unique = false;
    transition.alternatives.push_back(std::move(*other));
  }
}

Transition failed(const Occasion& occasion, const ModeState& before, const Surroundings& s, const std::string& why) {
  Transition transition;
  transition.state = before;
  transition.termination = result::Termination::outside_class;
  transition.message = fmt::format("higher-order sliding on {} at t = {} ends, and what follows is not determined: {}",
                                   names(s.system, before.sliding), occasion.t, why);
  return transition;
}

/// Leaves through the corner of a balance whose function can no longer be held; the others are held on.
Transition leave_balance(const Surroundings& s, const ModeState& before, const Occasion& occasion,
                         const std::vector<double>& x, std::size_t row) {
  HigherOrderField field(s.kernel);
  field.enter(*before.higher, before.sliding, before.alpha);
  field.evaluate(occasion.t, x.data());
  const auto& balances = before.higher->balances;
  std::size_t b = 0;
  while (balances[b].rows.front() != row) ++b;
  const bool falls = contains(occasion.exit_below, before.sliding[row]);
  const std::size_t corner = falls ? field.ranges()[b].highest : field.ranges()[b].lowest;
  std::vector<int> leaving;
  for (const std::size_t r : balances[b].rows) leaving.push_back(before.sliding[r]);
  ModeState state = before;
  state.higher.reset();
  std::string problem = "its fields do not lead away from it";
  if (leaving.size() < before.sliding.size()) {
    set_to_corner(state, leaving, corner);
    std::vector<double> point = x;
    auto held = hold(s, state, occasion, point, problem);
    if (!held) return failed(occasion, before, s, problem);
    if (!leads_into_its_region(s, held->state, occasion, point, leaving)) return failed(occasion, before, s, problem);
    for (const int j : leaving) held->zero_order[at(j)] = 2;
    held->reason = fmt::format("{}: no selection holds a derivative at 0 any more", names(s.system, leaving));
    return std::move(*held);
  }
  auto left = leave_to(s, state, occasion, x, leaving, corner);
  if (!left) return failed(occasion, before, s, problem);
  left->reason = fmt::format("{}: no selection holds a derivative at 0 any more", names(s.system, leaving));
  return std::move(*left);
}

/// Another surface is met: crossed, or slid on as well.
Transition meet(const Surroundings& s, const ModeState& before, const Occasion& occasion, const std::vector<double>& x,
                int surface) {
  const int mode = before.mode[at(surface)];
  ModeState behind = before;
  behind.higher.reset();
  std::string problem;
  set_surface(behind, surface, -mode, mode > 0 ? 0.0 : 1.0);
  std::vector<double> point = x;
  if (auto crossed = hold(s, behind, occasion, point, problem)) {
    if (leads_into_its_region(s, crossed->state, occasion, point, {surface})) {
      crossed->zero_order[at(surface)] = 1;
      crossed->reason = fmt::format("{}: crossed in higher-order sliding", s.system.switching[at(surface)].name);
      return std::move(*crossed);
    }
  }
  set_surface(behind, surface, 0, 0.5);
  point = x;
  if (auto joined = hold(s, behind, occasion, point, problem)) return std::move(*joined);
  return failed(occasion, before, s, problem);
}

}  // namespace

std::optional<Transition> hold_with_higher_order(const Surroundings& s, const ModeState& before,
                                                 const Occasion& occasion) {
  ModeState state = before;
  state.higher.reset();
  for (const int j : occasion.at_zero) set_surface(state, j, 0, 0.5);
  if (state.sliding != occasion.at_zero) return std::nullopt;
  std::vector<double> x(occasion.x, occasion.x + s.kernel.states());
  std::string problem;
  auto transition = hold(s, std::move(state), occasion, x, problem);
  if (!transition || !transition->state.higher) return std::nullopt;
  note_regions(s, occasion, x, *transition);
  return transition;
}

Transition decide_from_higher_order(const Surroundings& s, const ModeState& before, const Occasion& occasion) {
  const std::vector<double> x(occasion.x, occasion.x + s.kernel.states());
  std::vector<int> met, exits = occasion.exit_below;
  exits.insert(exits.end(), occasion.exit_above.begin(), occasion.exit_above.end());
  for (const int j : occasion.touched) {
    if (!contains(before.sliding, j)) met.push_back(j);
  }
  if (met.size() + exits.size() > 1) return failed(occasion, before, s, "several things happen at once");
  if (met.size() == 1) return meet(s, before, occasion, x, met.front());
  if (exits.size() == 1) {
    const auto row = std::find(before.sliding.begin(), before.sliding.end(), exits.front()) - before.sliding.begin();
    return leave_balance(s, before, occasion, x, static_cast<std::size_t>(row));
  }
  ModeState state = before;
  state.higher.reset();
  std::vector<double> point = x;
  std::string problem;
  auto held = hold(s, state, occasion, point, problem);
  return held ? std::move(*held) : failed(occasion, before, s, problem);
}

}  // namespace saltus::event_integrator
