// Functions around surfaces that change: they are read anew, jump away from zero, or have a kink there.
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "saltus/event_integrator/decide/transition_internal.hpp"
#include "saltus/event_integrator/mode/at_surface.hpp"
#include "saltus/event_integrator/mode/resolution.hpp"

namespace saltus::event_integrator {
namespace {

/// The functions inside function j, and those inside of these.
std::vector<bool> all_inside(const evaluation::ModelKernel& kernel, int j) {
  std::vector<bool> inside(at(kernel.switching_functions()));
  for (int i = j; i >= 0; --i) {  // inner functions have smaller indices
    if (i != j && !inside[at(i)]) continue;
    for (const int inner : kernel.inner(i)) inside[at(inner)] = true;
  }
  return inside;
}

void take_side(ModeState& state, int j, double psi) {
  set_surface(state, j, psi > 0.0 ? 1 : -1, psi > 0.0 ? 1.0 : 0.0);
}

/// The mode behind the touched surfaces inside function j, where they are crossed: those between them and j are read
/// anew. Returns whether j holds a selection that changes.
bool cross_inside(const SwitchingContext& s, const ModeState& before, const SwitchingPoint& switching_point, int j,
                  ModeState& behind) {
  std::vector<double> values(at(s.kernel.event_functions()));
  const ProjectedFields fields(s.kernel, switching_point);
  const auto inside = all_inside(s.kernel, j);
  const auto has_changed = [&](int i) { return behind.mode[at(i)] != before.mode[at(i)]; };
  const auto is_around_change = [&](int i) {
    const auto& inner = s.kernel.inner(i);
    return std::any_of(inner.begin(), inner.end(), has_changed);
  };
  for (int i = 0; i < j; ++i) {
    if (!inside[at(i)] || before.mode[at(i)] == 0 || has_changed(i)) continue;
    if (contains(switching_point.touched, i)) {
      take_side(behind, i, -before.mode[at(i)]);
    } else if (is_around_change(i) && !contains(switching_point.at_zero, i)) {
      s.kernel.functions(switching_point.t, switching_point.x, behind.alpha.data(), values.data());
      if (std::abs(values[at(i)]) > fields.noise(i)) take_side(behind, i, values[at(i)]);
    }
  }
  return is_around_change(j);
}

/// Crosses the touched surfaces inside function j, which is at zero: whether j is not, behind them, but jumps away.
bool jumps_away(const SwitchingContext& s, const ModeState& before, const SwitchingPoint& switching_point, int j,
                ModeState& state) {
  ModeState behind = state;
  if (!cross_inside(s, before, switching_point, j, behind)) return false;
  std::vector<double> values(at(s.kernel.event_functions()));
  s.kernel.functions(switching_point.t, switching_point.x, behind.alpha.data(), values.data());
  const double psi = values[at(j)];
  const double size =
      size_of(s.kernel, j, switching_point.t, switching_point.x, behind.alpha.data(), switching_point.time_scale);
  // Four digits above rounding, as for jumps on sliding surfaces: a kink leaves rounding, a jump something of size.
  if (!(std::abs(psi) > smallest_jump(size))) return false;
  take_side(behind, j, psi);
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
    take_side(state, j, psi);
    flipped = true;
  }
  return flipped;
}

/// The mode behind a crossing where function `jumping` gets away from zero: given, only its consequences are looked at.
Transition Decider::run_crossing(int jumping) {
  const std::string& name = s_.layout.surfaces[at(jumping)].name;
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
  ModeState behind = before;
  SwitchingPoint rest = switching_point;
  int jumping = -1;
  for (const int j : switching_point.at_zero) {
    if (s.kernel.inner(j).empty() || !jumps_away(s, before, switching_point, j, behind)) continue;
    jumping = j;
    for (auto* surfaces : {&rest.at_zero, &rest.touched, &rest.exit_below, &rest.exit_above}) std::erase(*surfaces, j);
  }
  if (jumping < 0) return std::nullopt;
  Transition crossed = Decider(s, behind, rest).run_crossing(jumping);
  // What was slid on may have been held by the fields before only: it is left then, too.
  if (crossed.termination != result::Termination::completed && !behind.sliding.empty()) {
    rest.touched = behind.sliding;
    Transition left = Decider(s, behind, rest).run();
    if (left.termination == result::Termination::completed) {
      left.reason = crossed.reason + (left.reason.empty() ? "" : "; " + left.reason);
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
    if (s.layout.surfaces[at(i)].role != model::SwitchingRole::kink || before.mode[at(i)] == 0) return std::nullopt;
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
