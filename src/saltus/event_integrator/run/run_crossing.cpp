// The ordinary switch: one surface is reached from beside it, in a region or while the solution slides on another one,
// or left where one of its fields is tangent, and nothing else happens there. What other switches need is left out:
// most copies of modes, occasions and transitions. The answers are those of the general way, bit for bit; where one is
// not clear that way is taken.
#include <algorithm>
#include <cmath>
#include <utility>

#include "saltus/event_integrator/run/run_internal.hpp"

namespace saltus::event_integrator {

/// Whether nothing but switching functions that hold no selections depends on modes, and nobody has asked for more
/// than one solution.
bool Run::has_ordinary_switches() const {
  const auto& system = surroundings_.system;
  for (int j = 0; j < kernel_.switching_functions(); ++j) {
    if (!kernel_.inner(j).empty()) return false;
  }
  return surroundings_.affine_in_alpha && kernel_.event_functions() == kernel_.switching_functions() &&
         kernel_.region_groups().empty() && system.events.empty() && jumps_.none() && options_.choices.empty() &&
         options_.layers.empty();
}

/// Whether one listed surface is reached in a region or while sliding on one, or left by the solution that slides on it
/// alone, behind the last switch.
bool Run::is_ordinary(const Located& located) const {
  if (!ordinary_ || located.functions.size() != 1 || state_.higher || !families_.idle()) return false;
  const auto& function = search_.functions()[located.functions.front()];
  const bool slides = state_.sliding.size() == 1 && field_.solve() == SlidingSolve::decoupled;
  const bool surface = function.kind == FunctionKind::surface && (search_.crosses() || slides);
  const bool exit = (function.kind == FunctionKind::exit_below || function.kind == FunctionKind::exit_above) && slides;
  return (surface || exit) && recorder_.lists(function.index) && located.t > t_ && located.t != series_.last();
}

/// Goes on behind an ordinary switch; otherwise nothing has happened.
bool Run::switch_shortly(const Located& located) {
  const auto& function = search_.functions()[located.functions.front()];
  if (function.kind != FunctionKind::surface) return leave(located, function);
  return state_.sliding.empty() ? meet(located, function.index) : pass(located, function.index);
}

/// A surface that is reached in a region.
bool Run::meet(const Located& located, int surface) {
  const auto j = at(surface);
  const double t = located.t;
  const double* x = located.x.data();
  const int mode = state_.mode[j];
  const double alpha = state_.alpha[j];
  field_(t, x, slope_.data());
  state_.alpha[j] = 1.0 - alpha;
  const auto& constants = field_memory_.of(state_.alpha, step_memory_.mark_with(j, -mode));
  state_.alpha[j] = alpha;
  kernel_.prepared_field(t, x, constants, slope_beyond_.data());
  const auto decision = mode < 0 ? single_surface_.decide(state_, surface, t, x, slope_, slope_beyond_)
                                 : single_surface_.decide(state_, surface, t, x, slope_beyond_, slope_);
  if (!decision) return false;
  const SurfaceSwitch change{surface, mode, decision->mode, alpha, decision->alpha, decision->reason};
  if (change.after != 0) {
    std::copy(located.x.begin(), located.x.end(), x_.begin());
    field_.cross(j, constants);
    slope_.swap(slope_beyond_);
  } else {
    field_.slide_from_region(j, change.alpha_after, mode < 0 ? Region::above : Region::below, constants);
    if (!begin_at(located)) return false;
  }
  go_on_behind(located, change);
  return true;
}

/// A surface that is reached while the solution slides on another one.
bool Run::pass(const Located& located, int surface) {
  const auto j = at(surface);
  const int slid = state_.sliding.front();
  field_(located.t, located.x.data(), slope_.data());
  const double selection = field_.alpha()[at(slid)];
  if (!is_finite(slope_) || !std::isfinite(selection)) return false;
  state_.alpha[at(slid)] = selection;
  look_at_both(located, slid, surface);
  const bool is_pair = surface_pair_.look(state_, occasion_, &field_);
  if (is_pair) {
    if (const auto alpha = surface_pair_.across(state_, occasion_)) return pass_across(located, surface, *alpha);
  }
  before_ = state_;
  const bool decided = is_pair ? surface_pair_.conclude(before_, occasion_, transition_)
                               : single_surface_.decide(before_, occasion_, transition_);
  if (!decided) return false;
  const auto& next = transition_.state;
  // The usual way: the solution goes on sliding across it.
  const bool across = next.mode[at(slid)] == 0 && next.mode[j] == -before_.mode[j];
  if (across) {
    pass_field(surface, next.alpha[j], next.alpha[at(slid)]);
  } else {
    field_.enter(next);
  }
  if (!begin_at(located)) return false;
  t_ = located.t;
  arrival_row_ = recorder_.rows();
  recorder_.switched(t_, x_, before_, transition_);
  recorder_.row_before(t_, located.x, before_, recorder_.events() - 1);
  state_ = next;
  stepper_.restart();
  stiffness_.reset();
  search_.enter(state_, transition_.zero_order, t_, x_.data());
  if (across) {
    recorder_.row(t_, x_, state_, field_.alpha());
    series_.note(t_, j, before_.mode[j]);
    h_ = step_memory_.change(state_.mode, j, t_, h_);
  } else {
    row(t_, x_);
    static_cast<void>(series_.repeats(t_, before_.mode, state_.mode));  // this is the first one at t
    h_ = step_memory_.change(state_.mode, t_, h_);
  }
  end_switch();
  if (too_many_events()) return true;
  note_tightening_switch();
  accumulate_switches();
  if (running_) watch_for_families();
  return true;
}

/// The same where the two surfaces influence each other and the solution goes on sliding across the one that it
/// reaches, with these selections, in the order of the occasion.
bool Run::pass_across(const Located& located, int surface, const switching::PlaneAlpha& alpha) {
  const auto j = at(surface);
  const int slid = state_.sliding.front();
  const std::size_t place = occasion_.at_zero[0] == surface ? 0 : 1;
  const SlidAcross across{slid, state_.alpha[at(slid)], alpha[1 - place], switching::Leaf::E3,
                          surface_pair_.meeting(state_, occasion_)};
  const SurfaceSwitch change{
      surface, state_.mode[j], -state_.mode[j], state_.alpha[j], alpha[place], switching::reason_of_passage(), &across};
  pass_field(surface, change.alpha_after, across.alpha_after);
  if (!begin_at(located)) return false;
  go_on_behind(located, change);
  return true;
}

/// The field of the mode in which the solution goes on sliding across a surface.
void Run::pass_field(int surface, double alpha, double selection) {
  const auto j = at(surface);
  const std::size_t mark = step_memory_.mark_with(j, -state_.mode[j]);
  field_.pass(j, alpha, selection, [&](const std::vector<double>& selections) -> const evaluation::FieldConstants& {
    return field_memory_.of(selections, mark);
  });
}

/// The state and the slope where the field in hand begins; false where that is not finite: the field is the one before.
bool Run::begin_at(const Located& located) {
  std::copy(located.x.begin(), located.x.end(), x_.begin());
  field_.project(located.t, x_.data());
  field_(located.t, x_.data(), slope_.data());
  if (is_finite(slope_)) return true;
  field_.enter(state_);
  return false;
}

/// Fills the occasion.
void Run::look_at_both(const Located& located, int slid, int reached) {
  occasion_.t = located.t;
  occasion_.x = located.x.data();
  occasion_.time_scale = h_scale_;
  occasion_.at_zero = {std::min(slid, reached), std::max(slid, reached)};
  occasion_.touched.assign(1, reached);
  for (auto* none : {&occasion_.exit_below, &occasion_.exit_above, &occasion_.coalesced, &occasion_.destabilised}) {
    none->clear();
  }
}

/// What follows a switch that was recorded and entered.
void Run::end_switch() {
  restart_control();
  const auto& times = options_.output.times;
  while (next_output_ < times.size() && times[next_output_] <= t_) ++next_output_;
  last_event_time_ = t_;
}

/// The only surface that is slid on, where the field of one side has become tangent to it.
bool Run::leave(const Located& located, const EventFunction& exit) {
  const int surface = exit.index;
  const auto j = at(surface);
  const double t = located.t;
  const double* x = located.x.data();
  field_(t, x, slope_.data());
  const double alpha = field_.alpha()[j];
  if (!is_finite(slope_) || !SingleSurface::is_within_bounds(alpha)) return false;
  const auto side = exit.kind == FunctionKind::exit_below ? Region::below : Region::above;
  field_.of_side(side, t, x, slope_beyond_.data());
  const SingleSurface::Motions motions{field_.sides(), search_.exit_rate(located.functions.front(), slope_beyond_)};
  const double before = std::exchange(state_.alpha[j], side == Region::below ? 0.0 : 1.0);
  const auto decision = single_surface_.decide_exit(state_, surface, {t, x, h_scale_}, motions, side);
  state_.alpha[j] = before;
  if (!decision) return false;
  x_ = located.x;
  state_.alpha[j] = alpha;
  field_.leave_to(side);
  slope_.swap(slope_beyond_);
  go_on_behind(located, {surface, 0, decision->mode, alpha, decision->alpha, decision->reason});
  return true;
}

/// The field is that of the mode behind, and x_ and slope_ are there.
void Run::go_on_behind(const Located& located, const SurfaceSwitch& change) {
  const auto j = at(change.surface);
  t_ = located.t;
  arrival_row_ = recorder_.rows();
  recorder_.switched(t_, x_, change);
  recorder_.row_before_last_event(located.x, state_.alpha);
  set_surface(state_, change.surface, change.after, change.alpha_after);
  if (change.slid != nullptr) state_.alpha[at(change.slid->surface)] = change.slid->alpha_after;
  stepper_.restart();
  stiffness_.reset();
  begin_search(change);
  const bool slides = change.after == 0 || change.slid != nullptr;
  recorder_.row_behind_last_event(x_, slides ? field_.alpha() : state_.alpha,
                                  change.slid != nullptr ? at(change.slid->surface) : j);
  series_.note(t_, j, change.before);
  h_ = step_memory_.change(state_.mode, j, t_, h_);
  end_switch();
  if (too_many_events()) return;
  note_tightening_switch(change);
  accumulate_switches();
  if (change.slid != nullptr && running_) watch_for_families();
}

/// The functions of the mode behind.
void Run::begin_search(const SurfaceSwitch& change) {
  const auto j = at(change.surface);
  const bool crosses = change.before != 0 && change.after != 0;
  if (crosses && change.slid == nullptr) return search_.cross(j, state_, t_, x_.data());
  set_corner_alpha(state_);
  if (crosses && search_.pass(j, state_, t_, x_.data())) return;
  zero_order_.assign(state_.mode.size(), 0);
  zero_order_[j] = crosses ? 1 : change.after == 0 ? 0 : 2;
  if (crosses) return search_.enter(state_, zero_order_, t_, x_.data());
  search_.enter_again(state_, zero_order_, t_, x_.data());
}

}  // namespace saltus::event_integrator
