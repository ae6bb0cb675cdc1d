#include "saltus/event_integrator/instant/user_signs.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "saltus/base/contains.hpp"
#include "saltus/event_integrator/mode/kept_by_sliding.hpp"

namespace saltus::event_integrator {
namespace {

/// User functions whose kinks are among the surfaces touched here.
std::vector<std::size_t> with_kinks_here(const RunState& run, const std::vector<int>& touched) {
  std::vector<std::size_t> found;
  const auto& functions = run.search.functions();
  for (std::size_t place = 0; place < functions.size(); ++place) {
    if (functions[place].kind != FunctionKind::user) continue;
    const auto& inner = run.kernel.inner(functions[place].index);
    const bool has_kink = std::any_of(touched.begin(), touched.end(), [&](int j) { return contains(inner, j); });
    if (has_kink) found.push_back(place);
  }
  return found;
}

}  // namespace

void flip_user_functions(const InstantContext& c, const Located& located) {
  auto& [run, cascade, out] = c;
  const Position& here = run.here;
  const auto each = [&](auto&& set) {
    for (std::size_t k = 0; k < located.functions.size(); ++k) {
      const auto& function = run.search.functions()[located.functions[k]];
      if (function.kind == FunctionKind::user) set(function.index, located.signs[k]);
    }
  };
  run.ledger.begin(here.t);
  // The signs before become known now, if they were not; only then do all of them change.
  each([&](int function, int sign) { run.ledger.set_sign(function, sign); });
  static_cast<void>(run.user_events.update(here.t, here.x.data(), here.state.alpha, run.ledger.signs()));
  each([&](int function, int sign) { run.ledger.put(function, -sign); });
}

void turn_by_mode_behind(const InstantContext& c, const Located& located) {
  auto& [run, cascade, out] = c;
  Position& here = run.here;
  const auto& functions = run.search.functions();
  SwitchingPoint point;
  point.begin(here.t, here.x.data(), here.time_scale);
  std::vector<std::size_t> compared;
  for (const std::size_t place : located.functions) {
    const auto& function = functions[place];
    if (function.kind == FunctionKind::surface) point.touched.push_back(function.index);
    const bool user = function.kind == FunctionKind::user;
    if (user && (run.jumps.is_compared(function.index) || run.user_events.is_compared(function.index)))
      compared.push_back(place);
  }
  if (point.touched.empty() || run.ledger.signs().empty()) return;
  auto turning = with_kinks_here(c.run, point.touched);
  std::erase_if(turning, [&](std::size_t place) {
    return run.ledger.sign(functions[place].index) != 0 && !contains(located.functions, place);
  });
  if (compared.empty() && turning.empty()) return;
  std::sort(point.touched.begin(), point.touched.end());
  point.at_zero = here.state.sliding;
  point.at_zero.insert(point.at_zero.end(), point.touched.begin(), point.touched.end());
  std::sort(point.at_zero.begin(), point.at_zero.end());
  const Transition next = decide_mode(run.switching, here.state, point);
  if (next.termination != result::Termination::completed) return;
  for (const std::size_t place : turning) {
    const int function = functions[place].index;
    run.ledger.put(function, side_ahead(run.switching, next.state, point, here.x, function));
  }
  for (const std::size_t place : compared) {
    const int function = functions[place].index;
    if (is_kept_by_sliding(run.kernel, next.state, function, here.t, here.x.data())) run.ledger.put(function, 0);
  }
}

std::vector<std::size_t> fire_user_events(const InstantContext& c, const std::vector<double>& x_before,
                                          const ModeState& before, const std::vector<std::size_t>& before_jumps) {
  auto& [run, cascade, out] = c;
  Position& here = run.here;
  auto fired = run.user_events.update(here.t, here.x.data(), here.state.alpha, run.ledger.signs());
  std::erase_if(fired, [&](std::size_t event) {
    const bool again = contains(before_jumps, event);
    return again && !run.switching.layout.events[event].is_condition();
  });
  for (const std::size_t event : fired) {
    run.recorder.user(here.t, {x_before, here.x, before, here.state}, static_cast<int>(event));
    if (run.user_events.stops(event) && run.running) {
      run.end(result::Termination::stopped_by_event,
              fmt::format("stopped by the event '{}'", run.switching.layout.events[event].name));
    }
  }
  return fired;
}

}  // namespace saltus::event_integrator
