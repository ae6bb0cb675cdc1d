// The ordinary switch: one surface is reached from beside it, or left where one of its fields is tangent. It is reached
// in a region or while the solution slides on another one. Nothing else happens there. What other switches need is left
// out: most copies of modes, switching points and transitions. The answers are those of the full decision, bit for bit,
// which is taken where one is not clear.
#include <algorithm>
#include <cmath>
#include <utility>

#include "saltus/event_integrator/run/run_internal.hpp"

namespace saltus::event_integrator {

/// Whether nothing but switching functions that hold no selections depends on modes, and nobody has asked for more
/// than one solution.
bool Run::has_ordinary_switches() const {
  const auto& system = switching_context_.system;
  for (int j = 0; j < kernel_.switching_functions(); ++j) {
    if (!kernel_.inner(j).empty()) return false;
  }
  return switching_context_.affine_in_alpha && kernel_.event_functions() == kernel_.switching_functions() &&
         kernel_.region_groups().empty() && system.events.empty() && jumps_.none() && options_.choices.empty() &&
         options_.layers.empty();
}

/// Returns whether the switch behind the last one is ordinary. One listed surface is reached in a region or while
/// sliding on one, or left by the solution that slides on it alone.
bool Run::is_ordinary(const Located& located) const {
  if (!fast_.applies || located.functions.size() != 1 || here_.state.higher || !choices_.families().idle())
    return false;
  const auto& function = search_.functions()[located.functions.front()];
  const bool slides = here_.state.sliding.size() == 1 && field_.solve() == SlidingSolve::decoupled;
  const bool surface = function.kind == FunctionKind::surface && (search_.crosses() || slides);
  const bool exit = (function.kind == FunctionKind::exit_below || function.kind == FunctionKind::exit_above) && slides;
  return (surface || exit) && recorder_.lists(function.index) && located.t > here_.t &&
         located.t != switches_.series().last();
}

/// Goes on behind an ordinary switch; otherwise nothing has happened.
bool Run::switch_fast(const Located& located) {
  const auto& function = search_.functions()[located.functions.front()];
  if (function.kind != FunctionKind::surface) return leave(located, function);
  return here_.state.sliding.empty() ? meet(located, function.index) : pass(located, function.index);
}

/// A surface that is reached in a region.
bool Run::meet(const Located& located, int surface) {
  const auto j = at(surface);
  const double t = located.t;
  const double* x = located.x.data();
  const int mode = here_.state.mode[j];
  const double alpha = here_.state.alpha[j];
  if (cross_locally(located, surface)) return true;
  field_.prepare();
  field_(t, x, here_.slope.data());
  here_.state.alpha[j] = 1.0 - alpha;
  const auto& constants = fast_.fields.of(here_.state.alpha, steps_.memory().mark_with(j, -mode));
  here_.state.alpha[j] = alpha;
  kernel_.prepared_field(t, x, constants, fast_.slope_beyond.data());
  const auto decision = mode < 0 ? fast_.single.decide(here_.state, surface, t, x, here_.slope, fast_.slope_beyond)
                                 : fast_.single.decide(here_.state, surface, t, x, fast_.slope_beyond, here_.slope);
  if (!decision) return false;
  const SurfaceSwitch change{surface, mode, decision->mode, alpha, decision->alpha, decision->reason};
  if (change.after != 0) {
    field_.cross(j, constants);
    here_.slope.swap(fast_.slope_beyond);
  } else {
    field_.slide_from_region(j, change.alpha_after, mode < 0 ? Region::above : Region::below, constants);
    if (!begin_at(located)) return false;
  }
  go_on_behind(located, change.after != 0 ? located.x : fast_.x, change);
  keep_step(surface);
  return true;
}

/// A surface of a large system that is crossed: only rows of the field are looked at. All of it is evaluated when a
/// step of all states begins.
bool Run::cross_locally(const Located& located, int surface) {
  if (!fast_.local.applies() || !fast_.single.has_rows(surface)) return false;
  const auto j = at(surface);
  const auto decision = fast_.single.decide_by_rows(here_.state, surface, located.t, located.x.data());
  if (!decision || decision->mode == 0) return false;
  const SurfaceSwitch change{surface,         here_.state.mode[j], decision->mode, here_.state.alpha[j],
                             decision->alpha, decision->reason};
  field_.cross(j, change.alpha_after);
  fast_.local.renew_slope(surface, located.t, located.x.data(), here_.state.alpha, here_.slope);
  go_on_behind(located, located.x, change);
  keep_step(surface);
  return true;
}

/// The solution behind the switch of a surface may stay on the dense output of the step before it, but for few states.
void Run::keep_step(int surface) {
  const auto* known = fast_.local.behind(surface, here_.t, here_.x, steps_.dense(), steps_.last_error(), here_.state);
  field_.follow_known(known);
  if (known != nullptr) {
    here_.h = known->h;
  } else if (field_.prepare()) {
    field_(here_.t, here_.x.data(), here_.slope.data());
  }
  // Its error is of a lower order than that of the steps.
  const double share = known != nullptr ? std::clamp(tolerances_.smallest_part(), 0.1, 1.0) : 1.0;
  tolerances_.limit(StepTolerances::Reason::local, {share, share});
}

/// A surface that is reached while the solution slides on another one.
bool Run::pass(const Located& located, int surface) {
  const auto j = at(surface);
  const int slid = here_.state.sliding.front();
  field_(located.t, located.x.data(), here_.slope.data());
  const double selection = field_.alpha()[at(slid)];
  if (!is_finite(here_.slope) || !std::isfinite(selection)) return false;
  here_.state.alpha[at(slid)] = selection;
  look_at_both(located, slid, surface);
  const bool is_pair = fast_.pair.look(here_.state, event_.switching_point, &field_);
  if (is_pair) {
    if (const auto alpha = fast_.pair.across(here_.state, event_.switching_point))
      return pass_across(located, surface, *alpha);
  }
  event_.before = here_.state;
  const bool decided = is_pair ? fast_.pair.conclude(event_.before, event_.switching_point, event_.transition)
                               : fast_.single.decide(event_.before, event_.switching_point, event_.transition);
  if (!decided) return false;
  const auto& next = event_.transition.state;
  // The usual way: the solution goes on sliding across it.
  const bool across = next.mode[at(slid)] == 0 && next.mode[j] == -event_.before.mode[j];
  if (across) {
    pass_field(surface, next.alpha[j], next.alpha[at(slid)]);
  } else {
    field_.enter(next);
  }
  if (!begin_at(located)) return false;
  here_.move_to(located.t, fast_.x.data());
  rows_.arrive(OutputRows::Arrival::missing);
  recorder_.switched(here_.t, here_.x, event_.before, event_.transition);
  recorder_.row_before(here_.t, located.x, event_.before, recorder_.events() - 1);
  here_.change_mode(next);
  steps_.begin_mode();
  search_.enter(here_.state, event_.transition.zero_order, here_.t, here_.x.data());
  if (across) {
    recorder_.row(here_.t, here_.x, here_.state, field_.alpha());
    switches_.series().note(here_.t, j, event_.before.mode[j]);
    here_.h = steps_.memory().change(here_.state.mode, j, here_.t, here_.h);
  } else {
    row(here_.t, here_.x);
    static_cast<void>(
        switches_.series().repeats(here_.t, event_.before.mode, here_.state.mode));  // this is the first one at t
    here_.h = steps_.memory().change(here_.state.mode, here_.t, here_.h);
  }
  end_switch();
  if (too_many_events()) return true;
  note_switch();
  accumulate_switches();
  if (outcome_.running) choices_.watch(field_);
  return true;
}

/// The same where the two surfaces influence each other and the solution goes on sliding across the one that it
/// reaches. The selections have the order of the switching point.
bool Run::pass_across(const Located& located, int surface, const switching::PlaneAlpha& alpha) {
  const auto j = at(surface);
  const int slid = here_.state.sliding.front();
  const std::size_t place = event_.switching_point.at_zero[0] == surface ? 0 : 1;
  const SlidAcross across{slid, here_.state.alpha[at(slid)], alpha[1 - place], switching::Leaf::E3,
                          fast_.pair.meeting(here_.state, event_.switching_point)};
  const SurfaceSwitch change{surface,
                             here_.state.mode[j],
                             -here_.state.mode[j],
                             here_.state.alpha[j],
                             alpha[place],
                             switching::reason_of_passage(),
                             &across};
  pass_field(surface, change.alpha_after, across.alpha_after);
  if (!begin_at(located)) return false;
  go_on_behind(located, fast_.x, change);
  return true;
}

/// The field of the mode in which the solution goes on sliding across a surface.
void Run::pass_field(int surface, double alpha, double selection) {
  const auto j = at(surface);
  const std::size_t mark = steps_.memory().mark_with(j, -here_.state.mode[j]);
  field_.pass(j, alpha, selection, [&](const std::vector<double>& selections) -> const evaluation::FieldConstants& {
    return fast_.fields.of(selections, mark);
  });
}

/// Finds the state, fast_.x, and the slope where the new field begins; false where that is not finite: the field is the
/// one before.
bool Run::begin_at(const Located& located) {
  fast_.x = located.x;
  field_.project(located.t, fast_.x.data());
  field_(located.t, fast_.x.data(), here_.slope.data());
  if (is_finite(here_.slope)) return true;
  field_.enter(here_.state);
  return false;
}

/// Fills the switching point.
void Run::look_at_both(const Located& located, int slid, int reached) {
  event_.switching_point.t = located.t;
  event_.switching_point.x = located.x.data();
  event_.switching_point.time_scale = here_.time_scale;
  event_.switching_point.at_zero = {std::min(slid, reached), std::max(slid, reached)};
  event_.switching_point.touched.assign(1, reached);
  for (auto* none : {&event_.switching_point.exit_below, &event_.switching_point.exit_above,
                     &event_.switching_point.coalesced, &event_.switching_point.destabilised}) {
    none->clear();
  }
}

/// What follows a switch that was recorded and entered.
void Run::end_switch() {
  restart_control();
  rows_.skip_here();
  event_.last_time = here_.t;
}

/// The only surface that is slid on, where the field of one side has become tangent to it.
bool Run::leave(const Located& located, const EventFunction& exit) {
  const int surface = exit.index;
  const auto j = at(surface);
  const double t = located.t;
  const double* x = located.x.data();
  field_(t, x, here_.slope.data());
  const double alpha = field_.alpha()[j];
  if (!is_finite(here_.slope) || !SingleSurface::is_within_bounds(alpha)) return false;
  const auto side = exit.kind == FunctionKind::exit_below ? Region::below : Region::above;
  field_.of_side(side, t, x, fast_.slope_beyond.data());
  const SingleSurface::Motions motions{field_.sides(),
                                       search_.exit_rate(located.functions.front(), fast_.slope_beyond)};
  const double before = std::exchange(here_.state.alpha[j], side == Region::below ? 0.0 : 1.0);
  const auto decision = fast_.single.decide_exit(here_.state, surface, {t, x, here_.time_scale}, motions, side);
  here_.state.alpha[j] = before;
  if (!decision) return false;
  here_.state.alpha[j] = alpha;
  field_.leave_to(side);
  here_.slope.swap(fast_.slope_beyond);
  go_on_behind(located, located.x, {surface, 0, decision->mode, alpha, decision->alpha, decision->reason});
  keep_step(surface);
  return true;
}

/// The field is that of the mode behind, which begins at x, and here_.slope is its slope there.
void Run::go_on_behind(const Located& located, const std::vector<double>& x, const SurfaceSwitch& change) {
  const auto j = at(change.surface);
  here_.move_to(located.t, x.data());
  rows_.arrive(OutputRows::Arrival::missing);
  recorder_.switched(here_.t, here_.x, change);
  recorder_.row_before_last_event(located.x, here_.state.alpha);
  set_surface(here_.state, change.surface, change.after, change.alpha_after);
  if (change.slid != nullptr) here_.state.alpha[at(change.slid->surface)] = change.slid->alpha_after;
  steps_.begin_mode();
  begin_search(change);
  const bool slides = change.after == 0 || change.slid != nullptr;
  recorder_.row_behind_last_event(here_.x, slides ? field_.alpha() : here_.state.alpha,
                                  change.slid != nullptr ? at(change.slid->surface) : j);
  switches_.series().note(here_.t, j, change.before);
  here_.h = steps_.memory().change(here_.state.mode, j, here_.t, here_.h);
  end_switch();
  if (too_many_events()) return;
  switches_.note(change);
  accumulate_switches();
  if (change.slid != nullptr && outcome_.running) choices_.watch(field_);
}

/// The functions of the mode behind.
void Run::begin_search(const SurfaceSwitch& change) {
  const auto j = at(change.surface);
  const bool crosses = change.before != 0 && change.after != 0;
  if (crosses && change.slid == nullptr) return search_.cross(j, here_.state, here_.t, here_.x.data());
  set_corner_alpha(here_.state);
  fast_.zero_order.assign(here_.state.mode.size(), 0);
  fast_.zero_order[j] = crosses ? 1 : change.after == 0 ? 0 : 2;
  search_.enter(here_.state, fast_.zero_order, here_.t, here_.x.data());
}

}  // namespace saltus::event_integrator
