// The first steps away from a surface on which the field of the mode has an infinite derivative.
#include <algorithm>
#include <cmath>
#include <utility>

#include "saltus/event_integrator/field/held_functions.hpp"
#include "saltus/event_integrator/field/rooted_exit.hpp"
#include "saltus/event_integrator/mode/at_surface.hpp"
#include "saltus/event_integrator/run/run_internal.hpp"
#include "saltus/switching/table/independent_rows.hpp"

namespace saltus::event_integrator {

/// Onto all surfaces that meet, where f has a root of one of them: what is left of psi when another one is put to zero,
/// 1e-15, has a root of 3e-8, or none.
void Run::project_onto_roots(const Located& located) {
  if (!run_.kernel.region_groups().empty()) return;
  std::vector<int> surfaces = run_.here.state.sliding;
  for (const std::size_t i : located.functions) {
    const auto& function = run_.search.functions()[i];
    if (function.kind == FunctionKind::surface) surfaces.push_back(function.index);
  }
  const auto rooted = [&](int j) { return run_.kernel.has_root(j); };
  if (surfaces.size() < 2 || std::none_of(surfaces.begin(), surfaces.end(), rooted)) return;
  HeldFunctions held(run_.kernel);
  std::vector<HeldFunction> functions;
  std::vector<double> alpha = run_.here.state.alpha;
  for (const int j : surfaces) functions.push_back({j, 0});
  if (run_.here.state.higher) {
    for (const int j : run_.here.state.sliding) alpha[at(j)] = 0.5;
    for (const HeldFunction& function : run_.here.state.higher->functions) {
      if (function.order > 0) functions.push_back(function);
    }
  }
  const std::size_t count = functions.size();
  held.set(std::move(functions), std::move(alpha));
  held.differentiate(run_.here.t, run_.here.x.data());
  for (std::size_t i = 0; i < count; ++i) {
    if (!(held.independent_part(i) > switching::dependent_part)) return;
  }
  static_cast<void>(held.project(run_.here.t, run_.here.x.data()));
}

/// The time scale of what is decided behind a step. Steps that end where a field is undefined say nothing of it: they
/// go down to the resolution of t. Without surfaces that are slid on beside roots (super-twisting) they are those of
/// cycles that shrink, and say it.
void Run::note_time_scale(double h) {
  const bool is_cut = steps_.was_undefined() && zeros_.any_continued();
  run_.here.time_scale = is_cut ? std::max(h, std::min(run_.here.time_scale, run_.here.t - run_.last_event)) : h;
}

/// A state at rest on a kink is on either side of it; the root says into which one it goes.
void Run::take_side_of_root() {
  const auto j = at(event().rooted);
  if (run_.switching.layout.surfaces[j].role != model::SwitchingRole::kink) return;
  const auto leads_away = [&](const ModeState& state) {
    return RootedExit(run_.kernel, run_.switching.affine_in_alpha, state, event().rooted)
        .leads_away(run_.here.t, run_.here.x, root_step());
  };
  Instant instant{.cause = Instant::Cause::given};
  Transition& other = instant.transition;
  other.state = run_.here.state;
  set_surface(other.state, event().rooted, -run_.here.state.mode[j], run_.here.state.mode[j] > 0 ? 0.0 : 1.0);
  set_corner_alpha(other.state);
  other.zero_order.assign(run_.here.state.mode.size(), 0);
  other.zero_order[j] = 2;
  other.rooted = event().rooted;
  if (!leads_away(run_.here.state) && leads_away(other.state)) static_cast<void>(resolver_.resolve(instant));
}

void Run::leave_root() {
  const int surface = std::exchange(event().rooted, -1);
  if (!run_.kernel.has_root(surface)) return leave_nested_root();
  RootedExit exit(run_.kernel, run_.switching.affine_in_alpha, run_.here.state, surface);
  const double begin = run_.here.t;
  const double limit = next_stop();
  double h = root_step();
  // Of -1.5 sqrt(x) + t^2 the derivative falls like 1/t^2 only: explicit steps, three over the stiffness each, are
  // worth while when a hundred of them double the time since the exit.
  constexpr double steps_left = 300.0;
  constexpr int most_steps = 200;
  for (int taken = 0; taken < most_steps && run_.here.t < limit && h > run_.here.smallest_step();) {
    if (run_.here.t > begin && exit.stiffness(run_.here.t, run_.here.x) * (run_.here.t - begin) <= steps_left) break;
    const double t_new = run_.here.t + h >= limit ? limit : run_.here.t + h;
    const auto x_new = exit.step(run_.here.t, run_.here.x, t_new - run_.here.t, run_.tolerances.step());
    // What else happens is located by ordinary steps.
    if (!x_new || !zeros_.keep_their_signs(surface, t_new, x_new->data())) {
      ++statistics_.rejected;
      h *= 0.25;
      continue;
    }
    run_.rows.each_before(run_.here.t, t_new, [&](double t) {
      run_.row(t, exit.step(run_.here.t, run_.here.x, t - run_.here.t, run_.tolerances.step()).value_or(*x_new));
    });
    ++taken;
    ++statistics_.steps;
    run_.here.move_to(t_new, x_new->data());
    run_.rows.write_end_of_step();
    h *= 2.0;
  }
  if (run_.here.t == begin) return;
  begin_same_mode(-1);
  if (run_.running) start_step();
}

/// The same mode from here, with a zero of one surface at most.
void Run::begin_same_mode(int zero) {
  Instant instant{.cause = Instant::Cause::given};
  instant.transition.state = run_.here.state;
  instant.transition.zero_order.assign(run_.here.state.mode.size(), 0);
  if (zero >= 0) instant.transition.zero_order[at(zero)] = 1;
  static_cast<void>(resolver_.resolve(instant));
}

/// Over the first cycle of a spiral that leaves an intersection, which is too small to be seen.
void Run::begin_spiral() {
  const SpiralStart start = *std::exchange(event().spiral, std::nullopt);
  const double t_new = std::min(run_.here.t + start.duration, run_.options.until);
  run_.rows.each_until(run_.here.t, t_new, [&](double t) { run_.row(t, start.x); });
  run_.here.move_to(t_new, start.x.data());
  begin_same_mode(start.surface);
  if (run_.running && run_.rows.at_steps()) run_.row(run_.here.t, run_.here.x);
}

}  // namespace saltus::event_integrator
