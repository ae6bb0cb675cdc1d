// The ordinary switch: one surface is reached from beside it, or left where one of its fields is tangent. It is reached
// in a region or while the solution slides on another one. Nothing else happens there. What other switches need is left
// out: most copies of modes, switching points and transitions. The answers are those of the full decision, bit for bit,
// which is taken where one is not clear.
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "saltus/event_integrator/mode/resolution.hpp"
#include "saltus/event_integrator/run/run_internal.hpp"

namespace saltus::event_integrator {

/// Whether nothing but switching functions that hold no selections depends on modes, and nobody has asked for more
/// than one solution.
bool Run::has_ordinary_switches() const {
  const auto& layout = run_.switching.layout;
  for (int j = 0; j < run_.kernel.switching_functions(); ++j) {
    if (!run_.kernel.inner(j).empty()) return false;
  }
  return run_.switching.affine_in_alpha && run_.kernel.event_functions() == run_.kernel.switching_functions() &&
         run_.kernel.region_groups().empty() && layout.events.empty() && run_.jumps.none() &&
         run_.options.choices.empty() && run_.options.layers.empty();
}

/// Returns whether the switch behind the last one is ordinary. One listed surface is reached in a region or while
/// sliding on one, or left by the solution that slides on it alone.
bool Run::is_ordinary(const Located& located) const {
  if (!fast_.applies || located.functions.size() != 1 || run_.here.state.higher || !choices_.families().idle())
    return false;
  const auto& function = run_.search.functions()[located.functions.front()];
  const bool slides = run_.here.state.sliding.size() == 1 && run_.field.solve() == SlidingSolve::decoupled;
  const bool surface = function.kind == FunctionKind::surface && (run_.search.crosses() || slides);
  const bool exit = function.is_side() && slides;
  return (surface || exit) && run_.recorder.lists(function.index) && located.t > run_.here.t &&
         located.t != switches_.series().last();
}

/// Says what an ordinary switch changes, by rules in the order in which they are asked. Returns false where the full
/// decision is to be asked.
bool Run::decide_ordinary(const Located& located, ModeChange& change) {
  using Rule = bool (Run::*)(const Located&, const EventFunction&, ModeChange&);
  static constexpr std::array<Rule, 4> rules_in_order{&Run::cross_by_rows, &Run::meet, &Run::leave, &Run::pass_beside};
  const auto& function = run_.search.functions()[located.functions.front()];
  return std::any_of(rules_in_order.begin(), rules_in_order.end(),
                     [&](const Rule rule) { return (this->*rule)(located, function, change); });
}

/// A surface of a large system that is crossed: only rows of the field are looked at. All of it is evaluated when a
/// step of all states begins.
bool Run::cross_by_rows(const Located& located, const EventFunction& reached, ModeChange& change) {
  if (!run_.here.state.sliding.empty() || !fast_.local.applies() || !resolver_.single().has_rows(reached.index))
    return false;
  const int surface = reached.index;
  const SingleSurface::Place place{surface, 0, located.t, located.x.data(), run_.here.time_scale};
  const auto velocities = resolver_.single().velocities_by_rows(run_.here.state.alpha, place);
  const auto decision =
      resolver_.single().decide(run_.here.state.alpha, run_.here.state.mode[at(surface)], place, velocities);
  if (!decision || decision->mode == 0) return false;
  fast_.local.renew_slope(surface, located.t, located.x.data(), run_.here.state.alpha, run_.here.slope);
  change_surface(surface, decision->mode, decision->alpha, decision->reason, change);
  change.is_evaluated = true;
  return true;
}

/// A surface that is reached in a region.
bool Run::meet(const Located& located, const EventFunction& reached, ModeChange& change) {
  if (!run_.here.state.sliding.empty()) return false;
  const SingleSurface::Place place{reached.index, 0, located.t, located.x.data(), run_.here.time_scale};
  const int mode = run_.here.state.mode[at(reached.index)];
  run_.field.prepare();
  run_.field(place.t, place.x, run_.here.slope.data());
  const auto* beyond = &constants_beyond(reached.index, 0.0);
  run_.kernel.prepared_field(place.t, place.x, *beyond, fast_.slope_beyond.data());
  const auto velocities =
      mode < 0 ? resolver_.single().velocities_of(run_.here.slope, fast_.slope_beyond, run_.here.state, place)
               : resolver_.single().velocities_of(fast_.slope_beyond, run_.here.slope, run_.here.state, place);
  const auto decision = resolver_.single().decide(run_.here.state.alpha, mode, place, velocities);
  if (!decision) return false;
  change_surface(reached.index, decision->mode, decision->alpha, decision->reason, change);
  change.beyond[0] = beyond;
  change.is_evaluated = decision->mode != 0;
  if (change.is_evaluated) run_.here.slope.swap(fast_.slope_beyond);
  return true;
}

/// The only surface that is slid on, where the field of one side has become tangent to it.
bool Run::leave(const Located& located, const EventFunction& exit, ModeChange& change) {
  if (exit.kind == FunctionKind::surface) return false;
  const auto side = exit.kind == FunctionKind::exit_below ? Region::below : Region::above;
  const SingleSurface::Place place{exit.index, side == Region::below ? -1 : 1, located.t, located.x.data(),
                                   run_.here.time_scale};
  run_.field(place.t, place.x, run_.here.slope.data());
  const double alpha = run_.field.alpha()[at(exit.index)];
  if (!is_finite(run_.here.slope) || !is_within_bounds(alpha)) return false;
  run_.field.of_side(side, place.t, place.x, fast_.slope_beyond.data());
  const auto bend = run_.search.exit_rate(located.functions.front(), fast_.slope_beyond);
  const auto decision = resolver_.single().decide(run_.here.state.alpha, 0, place,
                                                  {run_.field.sides().below, run_.field.sides().above}, bend);
  if (!decision) return false;
  run_.here.state.alpha[at(exit.index)] = alpha;
  run_.here.slope.swap(fast_.slope_beyond);
  change_surface(exit.index, decision->mode, decision->alpha, decision->reason, change);
  change.is_evaluated = true;
  return true;
}

/// A surface that is reached while the solution slides on another one.
bool Run::pass_beside(const Located& located, const EventFunction& reached, ModeChange& change) {
  if (run_.here.state.sliding.empty() || reached.kind != FunctionKind::surface) return false;
  const int slid = run_.here.state.sliding.front();
  run_.field(located.t, located.x.data(), run_.here.slope.data());
  const double selection = run_.field.alpha()[at(slid)];
  if (!is_finite(run_.here.slope) || !std::isfinite(selection)) return false;
  run_.here.state.alpha[at(slid)] = selection;
  SwitchingPoint& both = event().switching_point;
  Transition& transition = event().transition;
  both.begin(located.t, located.x.data(), run_.here.time_scale);
  both.at_zero = {std::min(slid, reached.index), std::max(slid, reached.index)};
  both.touched.assign(1, reached.index);
  const bool is_pair = resolver_.pair().look(run_.here.state, both, &run_.field);
  if (is_pair) {
    if (const auto across = resolver_.pair().across(run_.here.state, both)) {
      const int behind = -run_.here.state.mode[at(reached.index)];
      change_surface(reached.index, behind, behind > 0 ? 1.0 : 0.0, switching::reason_of_passage(), change);
      fast_.slid = *across;
      change.slid = &fast_.slid;
      change.beyond = {&constants_beyond(reached.index, 0.0), &constants_beyond(reached.index, 1.0)};
      return true;
    }
  }
  event().before = run_.here.state;
  const bool decided = is_pair ? resolver_.pair().conclude(event().before, both, transition)
                               : resolver_.single().decide(event().before, both, transition);
  if (decided) change = transition.from(event().before);
  return decided;
}

/// Only the mode of this surface is another one behind.
void Run::change_surface(int surface, int mode, double alpha, std::string_view reason, ModeChange& change) const {
  change.surface = surface;
  change.before = run_.here.state.mode[at(surface)];
  change.after = mode;
  change.alpha_before = run_.here.state.alpha[at(surface)];
  change.alpha_after = alpha;
  change.reason = reason;
}

/// Those of the region on the other side of a surface, on a side of what is slid on, if anything is.
const evaluation::FieldConstants& Run::constants_beyond(int surface, double side) {
  const auto j = at(surface);
  auto& selections = run_.here.state.alpha;
  const auto slid = run_.here.state.sliding.empty() ? j : at(run_.here.state.sliding.front());
  const double of_slid = std::exchange(selections[slid], side);
  const double own = std::exchange(selections[j], run_.here.state.mode[j] < 0 ? 1.0 : 0.0);
  const auto& constants = fast_.fields.of(selections, steps_.memory().mark_with(j, -run_.here.state.mode[j]));
  selections[j] = own;
  selections[slid] = of_slid;
  return constants;
}

/// Goes on behind an ordinary switch. Returns false where the new field is not finite there: it is the one before.
bool Run::go_on_behind(const Located& located, const ModeChange& change) {
  if (!change.is_evaluated) fast_.x = located.x;
  if (!begin_field(run_, change, located.t, fast_.x)) {
    run_.field.enter(run_.here.state);
    return false;
  }
  run_.here.move_to(located.t, change.is_evaluated ? located.x.data() : fast_.x.data());
  run_.rows.arrive(OutputRows::Arrival::missing);
  run_.recorder.switched(run_.here.t, run_.here.x, change);
  run_.recorder.row_before(run_.here.t, located.x, run_.here.state, run_.recorder.events() - 1);
  run_.here.change_mode(change);
  steps_.begin_mode();
  run_.search.begin(change, run_.here);
  const auto& selections = run_.here.state.sliding.empty() ? run_.here.state.alpha : run_.field.alpha();
  run_.recorder.row_behind(run_.here.x, run_.here.state, selections, change);
  switches_.series().note(run_.here.t, change);
  run_.here.h = steps_.memory().change(run_.here.state.mode, run_.here.t, run_.here.h, change);
  restart_control();
  run_.rows.skip_here();
  run_.last_event = run_.here.t;
  if (!too_many_events()) {
    switches_.note(change);
    accumulate_switches();
  }
  if (!next_.instant && change.is_single() && change.slid == nullptr) keep_step(change.surface);
  return true;
}

/// The solution behind the switch of a surface may stay on the dense output of the step before it, but for few states.
void Run::keep_step(int surface) {
  // Local steps are those of an explicit method.
  const auto* known =
      ode::is_implicit(steps_.method())
          ? nullptr
          : fast_.local.behind(surface, run_.here.t, run_.here.x, steps_.dense(), steps_.last_error(), run_.here.state);
  run_.field.follow_known(known);
  if (known != nullptr) {
    run_.here.h = known->h;
  } else if (run_.field.prepare()) {
    run_.field(run_.here.t, run_.here.x.data(), run_.here.slope.data());
  }
  // Its error is of a lower order than that of the steps.
  const double share = known != nullptr ? std::clamp(run_.tolerances.smallest_part(), 0.1, 1.0) : 1.0;
  run_.tolerances.limit(StepTolerances::Reason::local, {share, share});
}

}  // namespace saltus::event_integrator
