// What a step meets: the instants that are passed to the resolver, and the steps behind them.
#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "saltus/event_integrator/instant/contact_stage.hpp"
#include "saltus/event_integrator/run/run_internal.hpp"
#include "saltus/event_integrator/sequences/contracting_cycles.hpp"

namespace saltus::event_integrator {

using result::Termination;

void Run::come_to(const Located& located) { next_.zeros = &located; }

void Run::come_to(Instant::Cause cause) {
  next_.instant = Instant{.cause = cause, .row_is_written = run_.recorder.ends_at(run_.here.t)};
}

/// Passes what a step has come to, and what follows it at once: limits of sequences, and jumps behind them.
void Run::pass_instants() {
  const long events = run_.recorder.events();
  while (run_.running && next_.any()) {
    if (next_.zeros != nullptr) {
      pass_zeros(*std::exchange(next_.zeros, nullptr));
    } else {
      const Instant instant = std::move(*next_.instant);
      next_.instant.reset();
      pass(instant);
    }
  }
  if (run_.running && run_.recorder.events() > events) choices_.watch(run_.field);
}

/// The state moves to a located event, onto all that is held.
void Run::pass_zeros(const Located& located) {
  zeros_.forget();
  if (ModeChange change; is_ordinary(located) && decide_ordinary(located, change) && go_on_behind(located, change))
    return;
  Position& here = run_.here;
  Instant instant{.cause = Instant::Cause::zeros, .located = &located};
  // A step that ended exactly here has written the row before the event.
  instant.row_is_written = located.t == here.t && run_.recorder.ends_at(here.t) && here.t != run_.last_event;
  const double t_begin = here.t;
  here.move_to(located.t, located.x.data());
  static_cast<void>(run_.holding.project(here.t, here.state.alpha, here.x));
  put_on_gaps(run_, located);
  project_onto_roots(located);
  // A step may be as long as the mode.
  if (choices_.families().watches() && here.t > t_begin) choices_.look(t_begin, steps_);
  pass(instant);
}

void Run::pass(const Instant& instant) {
  if (!resolver_.resolve(instant) || !run_.running) return;
  if (way_ == Way::full_twice) resolve_again();
  start_steps(instant);
  if (!instant.is_limit()) return look_for_limits();
  if (run_.jumps.due(run_.here.t)) come_to(Instant::Cause::due);
}

/// What has come of an instant is what comes of it.
void Run::resolve_again() {
  if (resolver_.entered() == nullptr) return;
  Instant instant{.cause = Instant::Cause::given};
  instant.transition = *resolver_.entered();
  instant.transition.state = run_.here.state;
  static_cast<void>(resolver_.resolve(instant));
}

/// Steps behind an instant: as at a start behind jumps and limits, or like those before the switch.
void Run::start_steps(const Instant& instant) {
  const Outcome& outcome = event();
  Position& here = run_.here;
  if (outcome.jumped || instant.is_limit()) {
    const bool notes = outcome.jumped && !only_slips_on({run_, resolver_.cascade(), event()});
    if (notes) jump_accumulation_.note(resolver_.cascade(), run_.jumps);
    if (instant.cause == Instant::Cause::limit_of_switches) restart_control();
    choose_method();
    start_step();
    // The mode lasts from here; its step is that of a start.
    static_cast<void>(steps_.memory().change(here.state.mode, here.t, here.h));
    if (instant.cause == Instant::Cause::limit_of_switches) {
      here.time_scale = here.h;
      switches_.series().begin_anew();
    }
  } else if (outcome.switched) {
    restart_control();
    here.h = steps_.memory().change(here.state.mode, here.t, here.h, outcome.transition.from(outcome.before));
    if (outcome.by_one_surface && fast_.applies) keep_step(outcome.switching_point.touched.front());
  }
}

/// Whether what has happened is the last one of a sequence that has a limit.
void Run::look_for_limits() {
  const Outcome& outcome = event();
  if (too_many_events()) return;
  if (run_.recorder.events() > outcome.events_before) {
    if (outcome.before.mode != run_.here.state.mode) {
      if (outcome.jumped) {
        switches_.clear();
      } else {
        switches_.note({.mode_before = &outcome.before});
      }
    }
    accumulate_switches();
  }
  if (!next_.instant) accumulate_jumps();
  if (next_.unresolved) go_on_from_unresolved();
}

void Run::choose(Transition& transition) {
  if (std::exchange(next_.departs, false)) choices_.depart(progress());
  choices_.choose(transition, progress());
}

bool Run::note_switch(const ModeChange& change) {
  if (!switches_.series().note(run_.here.t, change)) return true;
  accumulates();
  return false;
}

void Run::begin_mode() {
  zeros_.forget();
  if (nested_.begin_mode()) run_.tolerances.lift(StepTolerances::Reason::zeros);
  steps_.begin_mode();
}

void Run::leave_undecided(const Outcome& outcome) {
  next_.unresolved = unresolved_here();
  if (next_.unresolved) return;
  const Position& here = run_.here;
  if (auto lost = lost_selections(run_.switching, outcome.before, here.t, here.x.data()))
    return run_.end(Termination::outside_class, std::move(*lost));
  const Transition& transition = outcome.transition;
  // Where switches accumulate the fields may have no limit: that is the reason then.
  const bool at_limit = transition.termination != Termination::outside_class && switches_.series().shrinks(here.t);
  if (at_limit) return accumulates();
  run_.end(transition.termination, transition.message);
}

/// A step as at a start: from the field of the continuous states alone, not beyond the last cycle of a shrinking
/// sequence of jumps.
void Run::start_step() {
  Position& here = run_.here;
  here.h = steps_.initial_step();
  if (const auto cycle = jump_accumulation_.last_cycle()) here.h = std::min(here.h, *cycle);
  std::vector<double> free_slope(here.x.size());
  run_.field(here.t, here.x.data(), free_slope.data());  // selections back to those of this point
}

/// Steps through the beginning of a slip in a plane are implicit.
void Run::choose_method() {
  const ode::Method wanted = steps_.choice().method();
  const bool may_turn = !run_.contacts.none() && !ode::is_implicit(wanted);
  const bool turns = may_turn && run_.contacts.turns_fast(run_.contact_moment(), run_.here.x);
  steps_.use(turns ? ode::Method::radau5 : wanted);
  run_.search.follow(steps_.method());
}

bool Run::too_many_events() {
  if (run_.recorder.events() >= run_.options.max_events) {
    const std::string cycles = ContractingCycles(run_.switching, run_.here, run_.recorder).describe();
    constexpr long last_events = 64;
    constexpr std::size_t most_names = 3;
    std::vector<std::string> names;
    for (std::size_t j = 0; j < run_.switching.layout.surfaces.size() && names.size() < most_names; ++j) {
      const auto& name = run_.switching.layout.surfaces[j].name;
      if (run_.recorder.switched_lately(static_cast<int>(j), last_events)) names.push_back(fmt::format("'{}'", name));
    }
    const std::string advice = names.empty() ? "see what happens in the last events"
                                             : fmt::format("see why {} switch{} so often", fmt::join(names, ", "),
                                                           names.size() == 1 ? "es" : "");
    // More events are of no use for a sequence without an end.
    run_.end(Termination::iteration_limit,
             fmt::format("max_events = {} reached at {}; {}", run_.options.max_events, run_.where(),
                         cycles.empty() ? "raise simulate.max_events if they are meant, or " + advice : cycles));
    return true;
  }
  // Jumps have their own limits, and what is listed only has none.
  if (event().jumped || event().listed_only || !switches_.series().too_dense(run_.here.t)) return false;
  if (!follow_dense_cycles()) accumulates();
  return true;
}

void Run::accumulates() {
  if (stopped_by_two_fold()) return;
  run_.end(
      Termination::outside_class,
      fmt::format(
          "switches accumulate at t = {:.17g} (spiral into an intersection of surfaces, or chattering), and the fields "
          "there do not say what follows their limit; end the simulation before, or perturb a parameter",
          run_.here.t));
}

}  // namespace saltus::event_integrator
