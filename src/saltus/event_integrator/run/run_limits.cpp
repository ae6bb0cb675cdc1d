// Sequences of switches and jumps that accumulate, and the mode behind the limit of switches.
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "saltus/base/without_repeats.hpp"
#include "saltus/event_integrator/decide/continuations.hpp"
#include "saltus/event_integrator/decide/tied_indicators.hpp"
#include "saltus/event_integrator/field/held_functions.hpp"
#include "saltus/event_integrator/mode/at_surface.hpp"
#include "saltus/event_integrator/mode/mode_differences_internal.hpp"
#include "saltus/event_integrator/mode/regions.hpp"
#include "saltus/event_integrator/run/run_internal.hpp"

namespace saltus::event_integrator {
namespace {

/// All surfaces of the cycles at zero, and all of their regions active; but for functions that jump over zero on
/// surfaces inside them.
/// @param limit  of the cycles
/// @param time_scale  a step of the integrator
void hold_at_zero(const evaluation::ModelKernel& kernel, const SeriesLimit& limit, double time_scale,
                  ModeState& state) {
  const auto& labels = limit.events;
  const auto is_nested = [&](int j) { return !kernel.inner(j).empty(); };
  std::vector<std::vector<ActiveRegion>> active(kernel.region_groups().size());
  for (const int label : labels) {
    const int surface = surface_of(label);
    bool is_region = false;
    for (std::size_t g = 0; g < active.size(); ++g) {
      if (!kernel.region_groups()[g].holds(surface)) continue;
      is_region = true;
      const auto known = [&](const ActiveRegion& region) { return region.region == surface; };
      if (std::none_of(active[g].begin(), active[g].end(), known)) active[g].push_back({surface, 0.0});
    }
    if (!is_region && !is_nested(surface)) set_surface(state, surface, 0, 0.5);
  }
  for (const int label : labels) {  // inner functions have smaller numbers
    const int surface = surface_of(label);
    if (!is_nested(surface) || state.mode[at(surface)] == 0) continue;
    const auto corners = corners_at(state, sliding_inside(kernel, state, surface));
    const bool jumps = !continuous_across(kernel, corners, surface, limit.t, limit.x, time_scale);
    if (!jumps) set_surface(state, surface, 0, 0.5);
  }
  for (std::size_t g = 0; g < active.size(); ++g) {
    for (auto& region : active[g]) region.weight = 1.0 / static_cast<double>(active[g].size());
    if (!active[g].empty()) set_active(state, kernel.region_groups()[g], active[g]);
  }
  set_corner_alpha(state);
}

/// Functions inside those that are put on, which the cycles shrink with them: they vanish there, too. Returns whether
/// there are any.
/// @param cycle_change  of each function: what a cycle changes it by
bool hold_inner_at_zero(const evaluation::ModelKernel& kernel, const SeriesLimit& limit,
                        const std::vector<double>& cycle_change, ModeState& state) {
  std::vector<double> values(at(kernel.event_functions()));
  kernel.functions(limit.t, limit.x.data(), state.alpha.data(), values.data());
  const std::vector<int> around = state.sliding;
  bool any = false;
  for (const int j : around) {
    for (const int i : kernel.inner(j)) {
      constexpr double part = 0.1;  // the limit is far nearer than the last cycle
      if (state.mode[at(i)] == 0 || !(std::abs(values[at(i)]) <= part * cycle_change[at(i)])) continue;
      set_surface(state, i, 0, 0.5);
      any = true;
    }
  }
  return any;
}

/// x onto surfaces some of which hold the signs of others.
void put_onto_nested(const evaluation::ModelKernel& kernel, const ModeState& state, double t, std::vector<double>& x) {
  std::vector<HeldFunction> functions;
  std::vector<double> alpha = state.alpha;
  for (const int j : state.sliding) {
    functions.push_back({j, 0});
    alpha[at(j)] = 0.5;
  }
  HeldFunctions held(kernel);
  held.set(std::move(functions), std::move(alpha));
  static_cast<void>(held.project(t, x.data()));
}

}  // namespace

/// Behind a switch that was noted: if those up to here have a limit that nothing else precedes, the run goes on from
/// there.
void Run::accumulate_switches() {
  switches_.limit_tolerances(roots_of_cycles());
  if (switches_.empty()) return;
  const auto limit = switches_.limit();
  if (const auto nearly = limit ? std::nullopt : switches_.nearly(); nearly && nearly->t < run_.options.until) {
    if (follow_spiral(*nearly, Behind::higher_order)) return switches_.clear();
  }
  if (!limit || limit->kind == SeriesKind::chattering ||
      limit->t > std::min(run_.options.until, run_.jumps.next_time()))
    return;
  const bool repeats = switches_.limits_repeat(limit->t);
  switches_.clear();
  if (repeats || !follow_spiral(*limit, Behind::any)) accumulates();
}

/// The current switch cannot be decided, in a cycle beside a root that is not resolved, nor are the rates of the fields
/// there: cycles have their limit where they are. nullopt where it is none of such cycles.
std::optional<SeriesLimit> Run::unresolved_here() const {
  if (event().switching_point.touched.size() != 1) return std::nullopt;
  const int surface = event().switching_point.touched.front();
  if (!zeros_.ends_at(surface)) return std::nullopt;
  return switches_.unresolved(surface, event().before.mode[at(surface)], run_.here.t - run_.last_event);
}

/// Goes on from the limit that an undecided switch has turned out to be.
void Run::go_on_from_unresolved() {
  const SeriesLimit limit = *std::exchange(next_.unresolved, std::nullopt);
  switches_.clear();
  switches_.limit_tolerances(roots_of_cycles());
  const Transition& undecided = event().transition;
  if (!follow_spiral(limit, Behind::any)) run_.end(undecided.termination, undecided.message);
}

/// Events cannot be told apart here: surfaces that are zero together, as far as the tolerances tell, may be held so,
/// with their derivatives (controllers with roots of several states, which reach their origin faster than cycles
/// shrink). Returns whether the run goes on.
bool Run::hold_unresolved() {
  SeriesLimit limit{run_.here.t, run_.here.x, {}, run_.here.smallest_step(), SeriesKind::unresolved};
  for (const auto* function : zeros_.unresolved()) limit.events.push_back(label_of(function->index, function->sign));
  return limit.events.size() > 1 && follow_spiral(limit, Behind::higher_order);
}

/// Cycles that hardly shrink are too many for their time before as little of it remains as a limit is asked for
/// usually. Returns whether they have one all the same, and the run goes on from there.
bool Run::follow_dense_cycles() {
  const auto limit = switches_.dense_limit();
  if (!limit || limit->kind == SeriesKind::chattering ||
      limit->t > std::min(run_.options.until, run_.jumps.next_time()))
    return false;
  switches_.clear();
  return follow_spiral(*limit, Behind::any);
}

/// Decides the mode behind the limit of switches; returns whether there is one, which comes next.
bool Run::follow_spiral(const SeriesLimit& limit, Behind wanted) {
  const Position& here = run_.here;
  FieldRates rates(run_.kernel, here);
  ModeState on = here.state;
  on.higher.reset();
  hold_at_zero(run_.kernel, limit, here.time_scale, on);
  std::vector<double> x = limit.x;
  std::vector<double> cycle_change(at(run_.kernel.event_functions()));
  for (const int j : on.sliding) {
    for (const int i : run_.kernel.inner(j)) {
      cycle_change[at(i)] = limit.cycle * std::abs(rates.here(i).value);
    }
  }
  if (hold_inner_at_zero(run_.kernel, limit, cycle_change, on)) {
    put_onto_nested(run_.kernel, on, limit.t, x);
  } else {
    const ReferenceScope references(run_.kernel, on);
    ModeField field(run_.kernel, run_.switching.affine_in_alpha);
    field.enter(on);
    field.project(limit.t, x.data());
  }
  SwitchingPoint point;
  point.t = limit.t;
  point.x = x.data();
  point.at_zero = point.touched = on.sliding;
  point.start = point.limit = true;  // no side is the one it comes from
  // What the last cycle changes is at rest behind it, and what t does not resolve.
  point.time_scale = std::max({here.time_scale, limit.cycle, 1e3 * rounding_unit * std::abs(limit.t)});
  note_ties(run_.kernel, on, point);
  Transition transition = decide_mode(run_.switching, on, point);
  if (transition.termination != result::Termination::completed) return false;
  if (wanted == Behind::higher_order && !transition.state.higher) return false;
  other_continuations(run_.switching, on, point, transition);
  // What has been slid on through all cycles may be left at their limit, too.
  std::vector<int> surfaces = on.sliding;
  for (const int label : limit.events) surfaces.push_back(surface_of(label));
  next_.instant = Instant{.cause = Instant::Cause::limit_of_switches, .limit = limit};
  next_.instant->transition = std::move(transition);
  next_.instant->x = std::move(x);
  next_.instant->surfaces = std::move(surfaces);
  return true;
}

/// If the jumps up to here have a limit that nothing else precedes, the run goes on from there. Where the last bounce
/// has come to rest at once, as no more was left of it than rounding, the limit is here: it is no term of the sequence,
/// and what would be extrapolated with it has another momentum.
void Run::accumulate_jumps() {
  if (run_.jumps.none()) return;
  const Position& here = run_.here;
  auto& last_bounces = event().last_bounces;
  auto limit = jump_accumulation_.limit();
  if (limit && !last_bounces.empty()) {
    limit->t = here.t;
    limit->x = here.x;
  }
  if (limit && limit->t <= std::min(run_.options.until, run_.jumps.next_time())) return follow_limit_of_jumps(*limit);
  if (last_bounces.empty()) return;
  jump_accumulation_.clear();
  drop_repeats(last_bounces);
  run_.recorder.accumulated(here.t, last_bounces, {here.x, here.x, here.state, here.state},
                            "no more is left of these impacts than rounding");
}

/// The limit of jumps comes next, with the guards that were at 0 at each of them last.
void Run::follow_limit_of_jumps(const SeriesLimit& limit) {
  Instant& instant = next_.instant.emplace();
  instant.cause = Instant::Cause::limit_of_jumps;
  instant.limit = limit;
  instant.of_contacts =
      std::any_of(limit.events.begin(), limit.events.end(), [&](int jump) { return run_.contacts.owns(jump); });
  if (instant.of_contacts) return jump_accumulation_.clear();
  for (const int jump : limit.events) {
    const auto guard = jump_accumulation_.last_guard(jump);
    if (!guard) continue;
    instant.guards.push_back(*guard);
    instant.rate = std::max(instant.rate, jump_accumulation_.last_rate(jump));
  }
  jump_accumulation_.end(limit);
}

}  // namespace saltus::event_integrator
