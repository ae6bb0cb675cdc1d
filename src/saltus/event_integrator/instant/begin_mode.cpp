// How modes begin, and the first one.
#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "saltus/base/at.hpp"
#include "saltus/base/contains.hpp"
#include "saltus/event_integrator/instant/jump_stage.hpp"
#include "saltus/event_integrator/instant/mass_beyond.hpp"
#include "saltus/event_integrator/instant/resolver.hpp"
#include "saltus/event_integrator/instant/rest_stage.hpp"
#include "saltus/event_integrator/mode/regions.hpp"
#include "saltus/event_integrator/mode/undefined.hpp"

namespace saltus::event_integrator {

using result::Termination;

bool begin_field(RunState& run, const ModeChange& change, double t, std::vector<double>& x) {
  run.field.begin(change);
  if (change.is_evaluated) return true;
  run.field.project(t, x.data());
  run.field(t, x.data(), run.here.slope.data());
  return is_finite(run.here.slope);
}

/// The state that a projection onto the surfaces of the mode has moved farther than errors of steps do, from where it
/// was met; -1 if there is none. Behind a jump of a surface nothing is projected.
int Resolver::state_moved_from(const std::vector<double>& met) const {
  const auto& [rtol, atol] = run_.options.tolerances;
  constexpr double many = 1e4, least = 1e-2, most = 0.1;
  // Of a state: what is located at roots, one inside the other, is known to a few digits.
  const double share = std::clamp(many * rtol, least, most);
  const auto& x = run_.here.x;
  for (std::size_t i = 0; i < met.size(); ++i) {
    const double size = std::max(std::abs(x[i]), std::abs(met[i]));
    if (std::abs(x[i] - met[i]) > many * atol + share * size) return static_cast<int>(i);
  }
  return -1;
}

/// Whether the field of the mode that begins is defined here; the run ends where it is not.
bool Resolver::is_finite_here() {
  if (is_finite(run_.here.slope)) return true;
  if (auto mass = indefinite_mass_beyond(run_)) {
    run_.end(Termination::outside_class, std::move(*mass));
    return false;
  }
  run_.end(
      Termination::evaluation_failed,
      fmt::format("the right-hand side of {} is not finite at {}; change the initial values, or guard the expression "
                  "with if(…)",
                  undefined_states(run_.switching.layout, run_.here.slope), run_.where()));
  return false;
}

/// The mode that was decided, with all parts that know the mode.
Resolver::Stage Resolver::begin_mode() {
  const Transition& transition = *entering_.transition;
  Position& here = run_.here;
  const ModeChange change = transition.from(out_.before);
  here.change_mode(change, run_.contacts.activities());
  set_references(run_.kernel, here.state);
  run_.tolerances.begin_mode(run_.kernel, run_.options.layers, here);
  run_.tolerances.lift(StepTolerances::Reason::local);
  client_.begin_mode();
  const std::vector<double> met = here.x;
  if (!begin_field(run_, change, here.t, here.x) && !transition.beside.empty()) {
    // The field is undefined on the far side of its own surface, where rounding has put the state.
    here.move_to(here.t, transition.beside.data());
    run_.field(here.t, here.x.data(), here.slope.data());
  }
  if (!is_finite_here()) return Stage::done;
  if (const int moved = state_moved_from(met); moved >= 0) {
    const double there = std::exchange(here.x, met)[at(moved)];
    run_.end(
        Termination::outside_class,
        fmt::format("sliding on from {} would need {} to jump from {:.6g} to {:.6g}: a switching function that is slid "
                    "on jumps there, and the continuation is not decided",
                    run_.where(), run_.switching.layout.state_names[at(moved)], met[at(moved)], there));
    return Stage::done;
  }
  run_.search.begin(change, here);
  out_.spiral = transition.beyond_spiral;
  out_.rooted = transition.rooted;
  return entering_.behind;
}

/// The first mode. At a break the field says into which cell the solution moves, and the cells say what the field is.
Start Resolver::decide_first() {
  const Position& here = run_.here;
  RestingSurfaces resting;
  if (!run_.contacts.none()) static_cast<void>(find_resting(context(), resting));  // no guard is held yet: no problem
  const auto decided = [&] {
    return decide_start(run_.switching, here.t, here.x.data(), here.time_scale, run_.options.initial_mode, resting);
  };
  auto start = decided();
  constexpr int most_passes = 4;
  for (int pass = 0; pass < most_passes && !run_.cells.empty(); ++pass) {
    if (start.transition.termination != Termination::completed) break;
    if (run_.cells.locate(here.t, here.x.data(), start.transition.state.alpha) == CellChange::none) break;
    start = decided();
  }
  return start;
}

/// A run that ends where it begins has one row.
bool Resolver::stop_at_start() {
  ModeState& state = run_.here.state;
  state.alpha.resize(state.mode.size(), 0.0);
  run_.recorder.row(run_.here.t, run_.here.x, state, state.alpha);
  return false;
}

bool Resolver::start() {
  Position& here = run_.here;
  constexpr double part_of_span = 1e-3;
  here.time_scale = part_of_span * run_.span();
  if (!is_finite(here.x)) {
    run_.end(Termination::evaluation_failed,
             fmt::format("the initial value of {} is not finite", undefined_states(run_.switching.layout, here.x)));
    return false;
  }
  if (!run_.cells.empty())
    run_.cells.locate(here.t, here.x.data(), std::vector<double>(at(run_.kernel.switching_functions()), 0.5));
  cascade_.begin();
  if (!event_integrator::begin_jumps(context())) return stop_at_start();
  auto start = decide_first();
  here.change_mode(start.transition.state);
  if (here.state.mode.empty()) here.state.mode.assign(at(run_.kernel.switching_functions()), 0);
  if (start.transition.termination != Termination::completed) {
    run_.end(start.transition.termination, start.transition.message);
    return stop_at_start();
  }
  client_.choose(start.transition);
  here.change_mode(start.transition.state);
  cascade_.transition() = start.transition;
  run(enter(start.transition, run_.jumps.none() ? Stage::done : Stage::rest));
  if (!run_.running) return stop_at_start();
  out_.transition = std::move(start.transition);
  record_start(start.at_zero);
  take_over_events();
  return true;
}

/// The start is an event where jumps are due, or something listed is at zero.
void Resolver::record_start(std::vector<int> listed) {
  const Position& here = run_.here;
  cascade_.end_execution();
  cascade_.transition().state = here.state;
  run_.row(here.t, here.x);
  for (const auto& [surface, mode] : run_.options.initial_mode) {
    if (!contains(listed, surface)) listed.push_back(surface);
  }
  if (!cascade_.executed().empty()) {
    run_.recorder.jumped(here.t, cascade_.executed().items(), nullptr, cascade_.transition());
    if (!cascade_.resting().empty()) {
      run_.recorder.accumulated(here.t, cascade_.resting(), {here.x, here.x, here.state, here.state}, resting_reason);
    }
    run_.last_event = here.t;
    return;
  }
  auto transition = out_.transition;
  transition.state = here.state;
  if (!listed.empty() && run_.recorder.started(here.t, here.x, transition, listed)) run_.row(here.t, here.x);
}

}  // namespace saltus::event_integrator
