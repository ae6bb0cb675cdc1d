#include "saltus/event_integrator/instant/resolver.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "saltus/base/at.hpp"
#include "saltus/event_integrator/instant/cell_stage.hpp"
#include "saltus/event_integrator/instant/contact_stage.hpp"
#include "saltus/event_integrator/instant/instant_rows.hpp"
#include "saltus/event_integrator/instant/jump_stage.hpp"
#include "saltus/event_integrator/instant/limit_stage.hpp"
#include "saltus/event_integrator/instant/rest_stage.hpp"
#include "saltus/event_integrator/instant/switch_stage.hpp"
#include "saltus/event_integrator/instant/user_signs.hpp"
#include "saltus/event_integrator/mode/regions.hpp"

namespace saltus::event_integrator {

using result::Termination;

Resolver::Resolver(RunState& run, ResolverClient& client)
    : run_(run),
      client_(client),
      cascade_(run.switching, run.here, run.field, run.search, run.ledger, run.jumps, run.contacts, run.holding),
      single_(run.switching),
      pair_(run.switching) {}

/// From a stage to the last one. What jumps have done is recorded where the run ends among them, too.
void Resolver::run(Stage stage) {
  jumping_.begun = jumping_.rested = jumping_.settled = false;
  while (run_.running && stage != Stage::done) stage = pass(stage);
  if (jumping_.begun) record_jumps();
}

Resolver::Stage Resolver::pass(Stage stage) {
  switch (stage) {
    case Stage::signs:
      return read_signs();
    case Stage::cells:
      return leave_cells();
    case Stage::switching:
      return decide();
    case Stage::conclusion:
      return conclude();
    case Stage::mode:
      return begin_mode();
    case Stage::switched:
      return record_switch();
    case Stage::changes:
      return follow_changes();
    case Stage::before_jumps:
      return fire_before_jumps();
    case Stage::jumps:
      return execute_due_jumps(context()) ? Stage::mode_of_jumps : Stage::done;
    case Stage::mode_of_jumps:
      return decide_behind_jumps();
    case Stage::rest:
      return hold_resting();
    case Stage::sides:
      return give_sides();
    case Stage::behind_jumps:
      jumping_.settled = check_behind_jumps(context());
      return Stage::done;
    case Stage::done:
      break;
  }
  return Stage::done;
}

/// Zeros that were located are passed; guards among them trigger jumps.
Resolver::Stage Resolver::read_signs() {
  const Located& located = *instant_->located;
  flip_user_functions(context(), located);
  turn_by_mode_behind(context(), located);
  run_.search.turn_users(run_.here.t, run_.here.x.data());
  cascade_.begin(located);
  if (!update_jumps(context())) return Stage::done;
  if (!run_.jumps.due(run_.here.t)) return Stage::cells;
  out_.cell_change = event_integrator::leave_cells(context(), located);
  return jump_from_here(true);
}

/// Jumps follow, from the motion before this instant, or from the one that has been decided in it.
Resolver::Stage Resolver::jump_from_here(bool of_mode_before) {
  jumping_.before = of_mode_before ? out_.before : run_.here.state;
  jumping_.x_before = of_mode_before ? out_.x_before : run_.here.x;
  return Stage::before_jumps;
}

Resolver::Stage Resolver::leave_cells() {
  const Located& located = *instant_->located;
  out_.released = release(context(), located);
  out_.cell_change = event_integrator::leave_cells(context(), located);
  if (leaves_resting_with_cells(context())) return jump_from_here(true);
  if (out_.cell_change != CellChange::jump && !change_resting_with_cells(context())) return Stage::switching;
  return run_.running && decide_behind_times(context()) ? Stage::conclusion : Stage::done;
}

/// The mode behind the surfaces that are at zero; or the same, where only cells and guards have changed.
Resolver::Stage Resolver::decide() {
  if (!collect_surfaces(context(), *instant_->located, client_.longest_step())) return Stage::done;
  const ModeState& from = touch_others(context());
  const Position& here = run_.here;
  if (time_moves_surfaces(context())) return decide_behind_times(context()) ? Stage::conclusion : Stage::done;
  if (!out_.switching_point.touched.empty()) {
    decide_touched(context(), from, single_, pair_);
    return Stage::conclusion;
  }
  if (out_.cell_change != CellChange::none) return enter_same(zeros_at(run_.kernel, here.state, here.t, here.x.data()));
  return out_.released ? enter_same(std::vector<int>(here.state.mode.size(), 0)) : Stage::changes;
}

Resolver::Stage Resolver::enter(const Transition& transition, Stage behind) {
  entering_ = {&transition, behind};
  return Stage::mode;
}

Resolver::Stage Resolver::enter_same(std::vector<int> zero_order) {
  out_.transition = Transition{};
  out_.transition.state = run_.here.state;
  out_.transition.zero_order = std::move(zero_order);
  return enter(out_.transition, Stage::changes);
}

/// One decision of those that are possible; a switch that cannot be decided is left to the client.
Resolver::Stage Resolver::conclude() {
  Transition& transition = out_.transition;
  if (transition.termination != Termination::completed) {
    client_.leave_undecided(out_);
    return Stage::done;
  }
  client_.choose(transition);
  return client_.note_switch(transition.from(out_.before)) ? enter(transition, Stage::switched) : Stage::done;
}

/// A mode has begun behind a switch. Cells that are looked up there may begin it once more.
Resolver::Stage Resolver::record_switch() {
  const Position& here = run_.here;
  if (!out_.evaluated && find_undefined_cells(run_)) {
    out_.evaluated = true;
    return enter(out_.transition, Stage::switched);
  }
  out_.evaluated = out_.switched = true;
  if (!run_.recorder.switched(here.t, here.x, out_.transition.from(out_.before)) &&
      client_.is_chosen(out_.transition)) {
    // To stay on a root that has lost its stability, or to change to the other one: the branch begins like a run in a
    // forced mode.
    run_.recorder.started(here.t, here.x, out_.transition, here.state.sliding);
  }
  return Stage::changes;
}

/// Events of the user behind a change of mode, and jumps: their conditions may depend on selections, too. Contacts
/// begin anew where a velocity along them does, as that of a belt.
Resolver::Stage Resolver::follow_changes() {
  const Position& here = run_.here;
  if (here.state.mode != out_.before.mode) {
    if (!run_.contacts.none()) {
      const Stage jumps = jump_from_here(false);  // from the point before they jump
      if (contacts_jump(context())) return jumps;
    }
    if (!run_.jumps.none()) cascade_.leave_guards(out_.transition.zero_order);
  }
  fire_user_events(context(), here.x, out_.before);
  if (!run_.running || run_.jumps.none() || !update_jumps(context()) || !run_.jumps.due(here.t)) return Stage::done;
  return jump_from_here(false);
}

/// Rule 4: events of the user of the motion before. One that stops the run lets the jumps of its time happen.
Resolver::Stage Resolver::fire_before_jumps() {
  out_.jumped = jumping_.begun = true;
  jumping_.fired = fire_user_events(context(), run_.here.x, jumping_.before);
  jumping_.stop = run_.status;
  run_.running = true;
  cascade_.note_guards();
  if (!cascade_.held_before().empty()) {
    run_.holding.release_all();
    run_.search.set_held({});
  }
  return Stage::jumps;
}

Resolver::Stage Resolver::decide_behind_jumps() {
  if (!event_integrator::decide_behind_jumps(context())) return Stage::done;
  if (run_.kernel.switching_functions() > 0) client_.choose(cascade_.transition());
  return enter(cascade_.transition(), jumping_.rested || is_limit_of_jumps() ? Stage::sides : Stage::rest);
}

/// Guards that come to rest change the field once.
Resolver::Stage Resolver::hold_resting() {
  jumping_.rested = true;
  return event_integrator::hold_resting(context()) ? Stage::mode_of_jumps : Stage::sides;
}

/// The motion behind says to which sides functions go that jumps have put at zero; that may trigger more.
Resolver::Stage Resolver::give_sides() {
  cascade_.give_directions();
  if (is_limit_of_jumps()) return Stage::done;  // what becomes due there is an instant of its own
  if (!update_jumps(context())) return Stage::done;
  if (!run_.jumps.due(run_.here.t)) return Stage::behind_jumps;
  jumping_.rested = false;
  return Stage::jumps;
}

/// Rules 5 and 6: the jumps as events, with those of the user that they cause.
void Resolver::record_jumps() {
  cascade_.end_execution();
  if (!only_slips_on(context())) {
    cascade_.transition().state = run_.here.state;
    run_.recorder.jumped(run_.here.t, cascade_.executed().items(), &jumping_.before, cascade_.transition());
  }
  if (!jumping_.settled) return;
  if (!cascade_.resting().empty()) {
    const ModeState& state = run_.here.state;
    run_.recorder.accumulated(run_.here.t, cascade_.resting(), {run_.here.x, run_.here.x, state, state},
                              resting_reason);
  }
  if (jumping_.stop.termination != Termination::completed) run_.end(jumping_.stop.termination, jumping_.stop.message);
  fire_user_events(context(), jumping_.x_before, jumping_.before, jumping_.fired);
}

/// What is true behind a start or a limit fires no events.
void Resolver::take_over_events() {
  const Position& here = run_.here;
  static_cast<void>(run_.user_events.update(here.t, here.x.data(), here.state.alpha, run_.ledger.signs()));
}

void Resolver::settle_signs() {
  take_over_events();
  cascade_.begin();
  run_.jumps.update(context().jump_point());
}

bool Resolver::resolve(const Instant& instant) {
  using Cause = Instant::Cause;
  instant_ = &instant;
  entering_ = {};
  if (instant.cause == Cause::given) {
    run(enter(instant.transition, Stage::done));
    return true;
  }
  if (instant.is_limit()) {
    resolve_limit(instant);
    return true;
  }
  arrive(context(), instant.row_is_written);
  if (instant.cause == Cause::due) {
    // Jumps read the values of tables and inputs from here on.
    out_.cell_change = event_integrator::leave_cells(context(), breaks_here(run_));
    cascade_.begin();
    const bool is_late = update_jumps(context()) && !run_.jumps.due(run_.here.t);
    if (is_late && out_.cell_change == CellChange::none) return false;
    if (is_late && decide_behind_times(context())) run(Stage::conclusion);
    if (!is_late && run_.running) run(jump_from_here(true));
  } else if (instant.cause == Cause::departure) {
    out_.transition = instant.transition;
    run(Stage::conclusion);
  } else {
    const auto& functions = instant.located->functions;
    out_.listed_only = std::all_of(functions.begin(), functions.end(),
                                   [&](std::size_t function) { return run_.search.is_listed_only(function); });
    run(Stage::signs);
  }
  write_rows(context());
  return true;
}

/// What has become due behind a limit is an instant of its own.
void Resolver::resolve_limit(const Instant& instant) {
  const ModeState before_last = out_.before;
  arrive(context(), true);
  is_limit_of_jumps() ? resolve_limit_of_jumps(instant, before_last) : resolve_limit_of_switches(instant);
  if (!run_.running) return;
  take_over_events();
  static_cast<void>(update_jumps(context()));
}

/// Behind the limit of switches its mode begins.
void Resolver::resolve_limit_of_switches(const Instant& instant) {
  pass_to(run_, instant.limit.t, instant.x);
  run(enter(instant.transition, Stage::done));
  if (run_.running) record_limit_of_switches(context(), instant);
}

/// Behind the limit of jumps their guards are at rest, gaps are closed, and the mode is decided as behind jumps.
void Resolver::resolve_limit_of_jumps(const Instant& instant, const ModeState& before_last) {
  const SeriesLimit& limit = instant.limit;
  bool begins = false;
  if (instant.of_contacts) {
    begins = settle_contacts(context(), limit, before_last);
  } else {
    pass_to(run_, limit.t, instant.limit.x);
    cascade_.begin();
    begins = rest_at_limit(context(), instant);
  }
  if (begins) run(Stage::mode_of_jumps);
  const bool changes_nothing = !instant.of_contacts && instant.guards.empty();
  if (run_.running && changes_nothing) run_.jumps.accept(limit.events, context().jump_point());
  record_limit_of_jumps(context(), limit.events,
                        instant.of_contacts
                            ? "the intervals of these impacts shrink geometrically: the gaps close in their limit"
                        : limit.kind == SeriesKind::chattering
                            ? "these jumps follow each other faster than their guards are resolved"
                            : "the intervals of these jumps shrink geometrically: the state is their limit");
}

}  // namespace saltus::event_integrator
