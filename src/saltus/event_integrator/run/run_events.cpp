#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "saltus/base/contains.hpp"
#include "saltus/evaluation/explanations.hpp"
#include "saltus/event_integrator/decide/continuations.hpp"
#include "saltus/event_integrator/decide/tied_indicators.hpp"
#include "saltus/event_integrator/mode/at_surface.hpp"
#include "saltus/event_integrator/mode/regions.hpp"
#include "saltus/event_integrator/run/run_internal.hpp"
#include "saltus/event_integrator/sequences/contracting_cycles.hpp"

namespace saltus::event_integrator {

using result::Termination;

/// @param before_jumps  what has fired before the jumps of this time: a zero that they leave at once on the side that
/// it
///                      was reached from is no second one
std::vector<std::size_t> Run::fire_user_events(const std::vector<double>& x_before, const ModeState& before,
                                               const std::vector<std::size_t>& before_jumps) {
  auto fired = user_events_.update(here_.t, here_.x.data(), here_.state.alpha, search_.user_signs());
  std::erase_if(fired, [&](std::size_t event) {
    const bool again = contains(before_jumps, event);
    return again && !switching_context_.layout.events[event].is_condition();
  });
  for (const std::size_t event : fired) {
    recorder_.user(here_.t, {x_before, here_.x, before, here_.state}, static_cast<int>(event));
    if (user_events_.stops(event) && outcome_.running) {
      fail(Termination::stopped_by_event,
           fmt::format("stopped by the event '{}'", switching_context_.layout.events[event].name));
    }
  }
  return fired;
}

/// What may help where all steps are used up.
std::string Run::advice_on_steps() {
  std::string norm = evaluation::vanishing_norm(kernel_, here_.t, here_.x);
  if (!norm.empty()) return norm;
  const std::string cycles = ContractingCycles(switching_context_, here_, recorder_).describe();
  const std::string raise = "; raise simulate.max_steps if they are meant";
  if (!cycles.empty()) return "; " + cycles;  // more steps are of no use
  const bool explicit_steps = options_.method == ode::Method::dopri5 || options_.method == ode::Method::dop853;
  const bool is_told = steps_.stiff_at().has_value();  // at the end of the message
  return raise + (explicit_steps && !is_told ? ", or try --integrator radau5: the model may be stiff" : "");
}

bool Run::too_many_events() {
  if (recorder_.events() >= options_.max_events) {
    const std::string cycles = ContractingCycles(switching_context_, here_, recorder_).describe();
    constexpr long last_events = 64;
    constexpr std::size_t most_names = 3;
    std::vector<std::string> names;
    for (std::size_t j = 0; j < switching_context_.layout.surfaces.size() && names.size() < most_names; ++j) {
      const auto& name = switching_context_.layout.surfaces[j].name;
      if (recorder_.switched_lately(static_cast<int>(j), last_events)) names.push_back(fmt::format("'{}'", name));
    }
    const std::string advice = names.empty() ? "see what happens in the last events"
                                             : fmt::format("see why {} switch{} so often", fmt::join(names, ", "),
                                                           names.size() == 1 ? "es" : "");
    // More events are of no use for a sequence without an end.
    fail(Termination::iteration_limit,
         fmt::format("max_events = {} reached at {}; {}", options_.max_events, where(),
                     cycles.empty() ? "raise simulate.max_events if they are meant, or " + advice : cycles));
    return true;
  }
  // Jumps have their own limits, and what is listed only has none.
  if (event_.jumped || event_.listed_only || !switches_.series().too_dense(here_.t)) return false;
  if (!follow_dense_cycles()) accumulates();
  return true;
}

void Run::accumulates() {
  if (stopped_by_two_fold()) return;
  fail(
      Termination::outside_class,
      fmt::format(
          "switches accumulate at t = {:.17g} (spiral into an intersection of surfaces, or chattering), and the fields "
          "there do not say what follows their limit; end the simulation before, or perturb a parameter",
          here_.t));
}

/// Whether a nested function reaches 0 on one side only of a surface that is slid on; that ends the run.
bool Run::jumps_while_sliding(int surface) {
  if (continuous_across(kernel_, corners_inside(kernel_, here_.state, surface), surface, here_.t, here_.x,
                        here_.time_scale)) {
    return false;
  }
  const auto name = [&](int j) { return switching_context_.layout.surfaces[at(j)].name; };
  fail(Termination::outside_class,
       fmt::format("'{}' jumps across the surface of '{}', on which the solution slides, and reaches 0 on one side of "
                   "it at t = {:.17g}: rewrite the nested term with named switching functions",
                   name(surface), name(sliding_inside(kernel_, here_.state, surface).front()), here_.t));
  return true;
}

/// Fills the switching point with the surfaces that are at zero here, and why; false where the run has ended.
bool Run::collect_surfaces(const Located& located) {
  SwitchingPoint& switching_point = event_.switching_point;
  switching_point.begin(here_.t, here_.x.data(), here_.time_scale);
  switching_point.at_zero = here_.state.sliding;
  for (const std::size_t place : located.functions) {
    const auto& function = search_.functions()[place];
    const bool is_surface = function.kind != FunctionKind::user && function.kind != FunctionKind::release;
    if (!is_surface || is_cell_end(function.kind)) continue;
    if (function.kind == FunctionKind::exit_below) switching_point.exit_below.push_back(function.index);
    if (function.kind == FunctionKind::exit_above) switching_point.exit_above.push_back(function.index);
    if (function.kind == FunctionKind::loss) {
      switching_point.coalesced.push_back(function.index);
      // Towards a root that is lost steps shrink to nothing, over which no field changes.
      switching_point.time_scale = std::max(switching_point.time_scale, steps_.longest());
    }
    if (function.kind == FunctionKind::instability) switching_point.destabilised.push_back(function.index);
    if (function.kind == FunctionKind::nested && jumps_while_sliding(function.index)) return false;
    auto& at_zero = switching_point.at_zero;
    const auto behind = std::lower_bound(at_zero.begin(), at_zero.end(), function.index);
    if (behind == at_zero.end() || *behind != function.index) at_zero.insert(behind, function.index);
    switching_point.touched.push_back(function.index);
  }
  return true;
}

/// Surfaces that are touched by what happens to others here: freed by a guard, or moved into another cell. Returns the
/// mode to decide from.
const ModeState& Run::touch_others() {
  const ModeState& from = event_.freed.empty() ? event_.before : slid_on_freed(event_.switching_point);
  for (const int j : here_.state.sliding) {
    // Sliding goes on with the new gradient, or ends, behind a kink of its own psi.
    if (event_.cell_change != CellChange::none && cells_.moved_in(j)) event_.switching_point.touched.push_back(j);
  }
  return from;
}

/// The mode goes on in other cells.
bool Run::keep_mode_in_cells() {
  if (event_.cell_change == CellChange::none) return true;
  event_.transition = Transition{};
  event_.transition.state = here_.state;
  event_.transition.zero_order = zeros_at(kernel_, here_.state, here_.t, here_.x.data());
  return enter(event_.transition);
}

bool Run::change_mode(const Located& located) {
  event_.cell_change = leave_cells(located);
  if (leaves_resting_with_cells()) {
    if (outcome_.running) static_cast<void>(jump(event_.before, event_.x_before));
    return false;
  }
  if (event_.cell_change == CellChange::jump || change_resting_with_cells())
    return outcome_.running && jump_with_cells();
  if (!collect_surfaces(located)) return false;
  SwitchingPoint& switching_point = event_.switching_point;
  const ModeState& from = touch_others();
  if (switching_point.touched.empty()) return keep_mode_in_cells();
  if (!kernel_.region_groups().empty()) complete_ties(kernel_, here_.state, switching_point);
  note_ties(kernel_, here_.state, switching_point);
  Transition& transition = event_.transition;
  const bool slope_holds = cells_.empty() && jumps_.none();  // no cell was left, and no guard released, here
  const SingleSurface::Motion known{here_.slope, field_.solve()};
  const bool single = fast_.single.decide(from, switching_point, transition, slope_holds ? &known : nullptr);
  if (!single && !fast_.pair.decide(from, switching_point, transition)) {
    transition = decide_mode(switching_context_, from, switching_point);
  }
  if (transition.termination == Termination::completed) {
    other_continuations(switching_context_, from, switching_point, transition);
  }
  if (!go_on()) return false;
  if (single && fast_.applies) keep_step(switching_point.touched.front());
  return true;
}

/// Into the mode that was decided at this time, with its event.
bool Run::go_on() {
  Transition& transition = event_.transition;
  if (transition.termination != Termination::completed) {
    event_.unresolved = unresolved_here();
    if (event_.unresolved) return false;
    if (auto lost = lost_selections(switching_context_, event_.before, here_.t, here_.x.data())) {
      fail(Termination::outside_class, std::move(*lost));
      return false;
    }
    // Where switches accumulate the fields may have no limit: that is the reason then.
    const bool at_limit = transition.termination != Termination::outside_class && switches_.series().shrinks(here_.t);
    if (at_limit) {
      accumulates();
      return false;
    }
    fail(transition.termination, std::move(transition.message));
    return false;
  }
  choices_.choose(transition, progress());
  const ModeChange change = transition.from(event_.before);
  if (switches_.series().note(here_.t, change)) {
    accumulates();
    return false;
  }
  if (!enter(transition)) return false;
  event_.evaluated = true;
  if (!find_undefined_cells()) return false;
  if (!recorder_.switched(here_.t, here_.x, change) && choices_.chooses(transition)) {
    // To stay on a root that has lost its stability, or to change to the other one: the branch begins like a run in a
    // forced mode.
    recorder_.started(here_.t, here_.x, transition, here_.state.sliding);
  }
  restart_control();
  here_.h = steps_.memory().change(here_.state.mode, here_.t, here_.h, change);
  return true;
}

/// User functions that vanish here continue with the other sign.
void Run::flip_user_functions(const Located& located) {
  const auto each = [&](auto&& set) {
    for (std::size_t k = 0; k < located.functions.size(); ++k) {
      if (search_.functions()[located.functions[k]].kind == FunctionKind::user)
        set(located.functions[k], located.signs[k]);
    }
  };
  // The signs before become known now, if they were not; only then do all of them change.
  each([&](std::size_t function, int sign) {
    if (search_.functions()[function].sign != sign) search_.set_user_sign(function, sign, here_.t, here_.x.data());
  });
  static_cast<void>(user_events_.update(here_.t, here_.x.data(), here_.state.alpha, search_.user_signs()));
  each([&](std::size_t function, int sign) { search_.set_user_sign(function, -sign, here_.t, here_.x.data()); });
}

/// Notes what is here before an event, the selections of a sliding mode among it.
Run::Arrival Run::arrive(OutputRows::Arrival row) {
  field_(here_.t, here_.x.data(), here_.slope.data());
  // 0/0 in the last bit where both fields are tangent: the selections that the mode began with are as good.
  if (!here_.state.sliding.empty() && is_finite(field_.alpha())) here_.state.alpha = field_.alpha();
  event_.before = here_.state;
  event_.x_before = here_.x;
  event_.jumped = event_.evaluated = event_.listed_only = false;
  event_.last_bounces.clear();
  event_.cells_before = cells_.indices();
  event_.cell_change = CellChange::none;
  rows_.arrive(row);
  return {recorder_.events(), row};
}

/// The state is at a located event: rows before and behind, user events, jumps or the next mode.
Run::Step Run::handle(const Located& located) {
  zeros_.forget();
  if (ModeChange change; is_ordinary(located) && decide_ordinary(located, change) && go_on_behind(located, change))
    return outcome_.running ? Step::taken : Step::failed;
  const bool ended_here = located.t == here_.t && recorder_.ends_at(here_.t) && here_.t != event_.last_time;
  // What was left at zero by the last event has moved away since, also where no step has ended in between.
  if (located.t > here_.t) search_.forget_user_zeros();
  const double t_begin = here_.t;
  here_.move_to(located.t, located.x.data());
  static_cast<void>(holding_.project(here_.t, here_.state.alpha, here_.x));
  put_on_gaps(located);
  project_onto_roots(located);
  // A step may be as long as the mode.
  if (choices_.families().watches() && here_.t > t_begin) choices_.look(t_begin, steps_);
  // A step that ended exactly here has written the row before the event.
  const Arrival arrival = arrive(ended_here ? OutputRows::Arrival::written : OutputRows::Arrival::missing);
  event_.listed_only = std::all_of(located.functions.begin(), located.functions.end(),
                                   [&](std::size_t function) { return search_.is_listed_only(function); });
  flip_user_functions(located);
  turn_by_mode_behind(located);
  cascade_.begin(located);
  jumps_.update(jump_point());
  if (jumps_have_problem()) return depart(arrival);
  if (jumps_.due(here_.t)) {
    event_.cell_change = leave_cells(located);
    static_cast<void>(jump(event_.before, event_.x_before));
    return depart(arrival);
  }
  const bool released = release(located);
  if (change_mode(located) && released && event_.freed.empty()) {
    Transition same;
    same.state = here_.state;
    same.zero_order.assign(here_.state.mode.size(), 0);
    static_cast<void>(enter(same));
  }
  if (outcome_.running) follow_change_of_mode();
  return depart(arrival);
}

/// User events behind a change of mode, and jumps: their conditions may depend on selections, too. Contacts begin anew
/// where a velocity along them does, as that of a belt.
void Run::follow_change_of_mode() {
  if (here_.state.mode != event_.before.mode) {
    const ModeState before = here_.state;
    const auto x_before = here_.x;
    if (contacts_jump()) {
      if (outcome_.running) static_cast<void>(jump(before, x_before));
      return;
    }
  }
  if (!jumps_.none() && here_.state.mode != event_.before.mode) cascade_.leave_guards(event_.transition.zero_order);
  fire_user_events(here_.x, event_.before);
  if (!outcome_.running || jumps_.none()) return;
  jumps_.update(jump_point());
  if (jumps_have_problem() || !jumps_.due(here_.t)) return;
  const ModeState before = here_.state;
  static_cast<void>(jump(before, std::vector<double>(here_.x)));
}

/// Whether a selection is another one than before that is no kink: one of time only, which makes no event.
bool Run::selections_jumped() const {
  for (std::size_t j = 0; j < here_.state.mode.size() && j < event_.before.mode.size(); ++j) {
    if (here_.state.mode[j] != event_.before.mode[j] && !switching_context_.layout.surfaces[j].is_kink) return true;
  }
  return false;
}

/// The row behind an event: the field of the mode behind it was evaluated here, unless something jumps.
void Run::row_behind() {
  if (!event_.evaluated || event_.jumped) return row(here_.t, here_.x);
  recorder_.row(here_.t, here_.x, here_.state, here_.state.sliding.empty() ? here_.state.alpha : field_.alpha());
}

/// Rows before and behind what has happened here.
void Run::write_rows_behind(const Arrival& arrival, bool event) {
  if (event || !outcome_.running) {
    if (arrival.row == OutputRows::Arrival::missing) rows_at_event(arrival);
    if (event) row_behind();
  } else if (rows_.at_steps()) {
    // Inputs and outputs may jump here: their values before and behind.
    if (event_.cell_change == CellChange::jump || (rows_.asks_for_lines() && selections_jumped()))
      rows_at_event(arrival);
    row(here_.t, here_.x);
  }
  // A requested time at a restart that is no event still gets its row.
  rows_.each_until(-infinity, here_.t, [&](double t) {
    const bool wanted =
        (t == here_.t || event_.cell_change != CellChange::none) && !event && !rows_.at_steps() && outcome_.running;
    if (wanted) row(t, here_.x);
  });
}

Run::Step Run::depart(const Arrival& arrival) {
  const bool event = recorder_.events() > arrival.events;
  write_rows_behind(arrival, event);
  if (event) event_.last_time = here_.t;
  if (outcome_.running && !too_many_events()) {
    if (event) {
      note_switch();
      accumulate_switches();
    }
    accumulate_jumps();
    if (event_.unresolved) go_on_from_unresolved();
  }
  if (recorder_.events() > arrival.events && outcome_.running) choices_.watch(field_);
  return outcome_.running ? Step::taken : Step::failed;
}

}  // namespace saltus::event_integrator
