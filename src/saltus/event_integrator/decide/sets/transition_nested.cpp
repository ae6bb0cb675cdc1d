// Functions around surfaces that change: they are read anew, jump away from zero, or have a kink there.
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "saltus/event_integrator/decide/transition_internal.hpp"
#include "saltus/event_integrator/mode/at_surface.hpp"
#include "saltus/event_integrator/mode/resolution.hpp"

namespace saltus::event_integrator {
namespace {

/// Crosses the touched surfaces inside function j, which is at zero: whether j is not, behind them, but jumps away.
bool jumps_away(const SwitchingContext& s, const SwitchingPoint& switching_point, int j, ModeState& state) {
  const auto& inner = s.kernel.inner(j);
  ModeState behind = state;
  bool crosses = false;
  for (const int i : switching_point.touched) {
    if (i == j || !contains(inner, i) || state.mode[at(i)] == 0) continue;
    set_surface(behind, i, -state.mode[at(i)], state.mode[at(i)] > 0 ? 0.0 : 1.0);
    crosses = true;
  }
  if (!crosses) return false;
  std::vector<double> values(at(s.kernel.event_functions()));
  s.kernel.functions(switching_point.t, switching_point.x, behind.alpha.data(), values.data());
  const double psi = values[at(j)];
  const double size =
      size_of(s.kernel, j, switching_point.t, switching_point.x, behind.alpha.data(), switching_point.time_scale);
  // Four digits above rounding, as for jumps on sliding surfaces: a kink leaves rounding, a jump something of size.
  if (!(std::abs(psi) > smallest_jump(size))) return false;
  set_surface(behind, j, psi > 0.0 ? 1 : -1, psi > 0.0 ? 1.0 : 0.0);
  state = std::move(behind);
  return true;
}

}  // namespace

/// Reads the sign of functions nested around a changed surface (or around a stepped input); true if one flipped.
bool Decider::read_nested_anew() {
  auto& state = transition_.state;
  bool flipped = false;
  std::vector<double> values(at(s_.kernel.event_functions()));
  for (int j = 0; j < s_.kernel.switching_functions(); ++j) {
    const auto& inner = s_.kernel.inner(j);
    if (inner.empty() || contains(switching_point_.at_zero, j) || state.mode[at(j)] == 0) continue;
    s_.kernel.functions(switching_point_.t, switching_point_.x, state.alpha.data(), values.data());
    const double psi = values[at(j)];
    if (!(std::abs(psi) > fields_.noise(j)) || (psi > 0.0) == (state.mode[at(j)] > 0)) continue;
    set_surface(state, j, psi > 0.0 ? 1 : -1, psi > 0.0 ? 1.0 : 0.0);
    flipped = true;
  }
  return flipped;
}

/// The mode behind a crossing where function `jumping` gets away from zero: given, only its consequences are looked at.
Transition Decider::run_crossing(int jumping) {
  const std::string& name = s_.system.switching[at(jumping)].name;
  read_nested_anew();
  if (set_corners()) check();
  if (transition_.termination == result::Termination::no_admissible_mode) {
    fail(result::Termination::outside_class,
         fmt::format("'{}' jumps away from 0 at t = {} on a surface inside it, and the field behind does not lead on: "
                     "the continuation needs the hidden dynamics of functions that jump",
                     name, switching_point_.t));
  }
  transition_.reason = fmt::format("'{}' jumps away from 0 on a surface inside it, which is crossed", name);
  return transition_;
}

std::optional<Transition> cross_with_jump(const SwitchingContext& s, const ModeState& before,
                                          const SwitchingPoint& switching_point) {
  std::optional<ModeState> behind;
  SwitchingPoint rest;
  int jumping = -1;
  for (const int j : switching_point.at_zero) {
    if (s.kernel.inner(j).empty()) continue;
    ModeState own = before;
    if (!jumps_away(s, switching_point, j, own)) continue;
    jumping = j;
    if (!behind) {
      behind = before;
      rest = switching_point;
    }
    for (auto* surfaces : {&rest.at_zero, &rest.touched, &rest.exit_below, &rest.exit_above}) std::erase(*surfaces, j);
    for (std::size_t k = 0; k < own.mode.size(); ++k) {
      if (own.mode[k] != before.mode[k]) set_surface(*behind, static_cast<int>(k), own.mode[k], own.alpha[k]);
    }
  }
  if (!behind) return std::nullopt;
  Transition crossed = Decider(s, *behind, rest).run_crossing(jumping);
  // What was slid on together with the function that jumps may be moved by its selection only: it is left then.
  const bool lost = crossed.termination == result::Termination::evaluation_failed && !behind->sliding.empty();
  if (lost && before.sliding.size() > behind->sliding.size()) {
    rest.touched = behind->sliding;
    Transition left = Decider(s, *behind, rest).run();
    if (left.termination == result::Termination::completed) {
      left.reason = crossed.reason + "; " + left.reason;
      return left;
    }
  }
  return crossed;
}

std::optional<Transition> cross_kinks(const SwitchingContext& s, const ModeState& before,
                                      const SwitchingPoint& switching_point) {
  if (switching_point.start) return std::nullopt;
  ModeState behind = before;
  SwitchingPoint rest = switching_point;
  rest.touched.clear();
  for (const int i : switching_point.touched) {
    if (s.system.switching[at(i)].role != model::SwitchingRole::kink || before.mode[at(i)] == 0) return std::nullopt;
    set_surface(behind, i, -before.mode[at(i)], before.mode[at(i)] > 0 ? 0.0 : 1.0);
    std::erase(rest.at_zero, i);
    for (const int j : before.sliding) {
      if (contains(s.kernel.inner(j), i) && !contains(rest.touched, j)) rest.touched.push_back(j);
    }
  }
  Transition transition = Decider(s, behind, rest).run();
  if (transition.termination != result::Termination::completed) return std::nullopt;
  const ProjectedFields fields(s.kernel, switching_point);
  for (const int i : switching_point.touched) {
    if (!(fields.velocities(transition.state.alpha, {i}).front() * transition.state.mode[at(i)] > 0.0)) {
      return std::nullopt;
    }
    transition.zero_order[at(i)] = 1;
  }
  return transition;
}

}  // namespace saltus::event_integrator
