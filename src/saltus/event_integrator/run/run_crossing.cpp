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
  const auto& layout = switching_context_.layout;
  for (int j = 0; j < kernel_.switching_functions(); ++j) {
    if (!kernel_.inner(j).empty()) return false;
  }
  return switching_context_.affine_in_alpha && kernel_.event_functions() == kernel_.switching_functions() &&
         kernel_.region_groups().empty() && layout.events.empty() && jumps_.none() && options_.choices.empty() &&
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

/// Says what an ordinary switch changes, by rules in the order in which they are asked. Returns false where the full
/// decision is to be asked.
bool Run::decide_ordinary(const Located& located, ModeChange& change) {
  using Rule = bool (Run::*)(const Located&, const EventFunction&, ModeChange&);
  static constexpr std::array<Rule, 4> rules_in_order{&Run::cross_by_rows, &Run::meet, &Run::leave, &Run::pass};
  const auto& function = search_.functions()[located.functions.front()];
  return std::any_of(rules_in_order.begin(), rules_in_order.end(),
                     [&](const Rule rule) { return (this->*rule)(located, function, change); });
}

/// A surface of a large system that is crossed: only rows of the field are looked at. All of it is evaluated when a
/// step of all states begins.
bool Run::cross_by_rows(const Located& located, const EventFunction& reached, ModeChange& change) {
  if (!here_.state.sliding.empty() || !fast_.local.applies() || !fast_.single.has_rows(reached.index)) return false;
  const int surface = reached.index;
  const SingleSurface::Place place{surface, 0, located.t, located.x.data(), here_.time_scale};
  const auto velocities = fast_.single.velocities_by_rows(here_.state.alpha, place);
  const auto decision = fast_.single.decide(here_.state.alpha, here_.state.mode[at(surface)], place, velocities);
  if (!decision || decision->mode == 0) return false;
  fast_.local.renew_slope(surface, located.t, located.x.data(), here_.state.alpha, here_.slope);
  change_surface(surface, decision->mode, decision->alpha, decision->reason, change);
  change.is_evaluated = true;
  return true;
}

/// A surface that is reached in a region.
bool Run::meet(const Located& located, const EventFunction& reached, ModeChange& change) {
  if (!here_.state.sliding.empty()) return false;
  const SingleSurface::Place place{reached.index, 0, located.t, located.x.data(), here_.time_scale};
  const int mode = here_.state.mode[at(reached.index)];
  field_.prepare();
  field_(place.t, place.x, here_.slope.data());
  const auto* beyond = &constants_beyond(reached.index, 0.0);
  kernel_.prepared_field(place.t, place.x, *beyond, fast_.slope_beyond.data());
  const auto velocities = mode < 0 ? fast_.single.velocities_of(here_.slope, fast_.slope_beyond, here_.state, place)
                                   : fast_.single.velocities_of(fast_.slope_beyond, here_.slope, here_.state, place);
  const auto decision = fast_.single.decide(here_.state.alpha, mode, place, velocities);
  if (!decision) return false;
  change_surface(reached.index, decision->mode, decision->alpha, decision->reason, change);
  change.beyond[0] = beyond;
  change.is_evaluated = decision->mode != 0;
  if (change.is_evaluated) here_.slope.swap(fast_.slope_beyond);
  return true;
}

/// The only surface that is slid on, where the field of one side has become tangent to it.
bool Run::leave(const Located& located, const EventFunction& exit, ModeChange& change) {
  if (exit.kind == FunctionKind::surface) return false;
  const auto side = exit.kind == FunctionKind::exit_below ? Region::below : Region::above;
  const SingleSurface::Place place{exit.index, side == Region::below ? -1 : 1, located.t, located.x.data(),
                                   here_.time_scale};
  field_(place.t, place.x, here_.slope.data());
  const double alpha = field_.alpha()[at(exit.index)];
  if (!is_finite(here_.slope) || !is_within_bounds(alpha)) return false;
  field_.of_side(side, place.t, place.x, fast_.slope_beyond.data());
  const auto bend = search_.exit_rate(located.functions.front(), fast_.slope_beyond);
  const auto decision =
      fast_.single.decide(here_.state.alpha, 0, place, {field_.sides().below, field_.sides().above}, bend);
  if (!decision) return false;
  here_.state.alpha[at(exit.index)] = alpha;
  here_.slope.swap(fast_.slope_beyond);
  change_surface(exit.index, decision->mode, decision->alpha, decision->reason, change);
  change.is_evaluated = true;
  return true;
}

/// A surface that is reached while the solution slides on another one.
bool Run::pass(const Located& located, const EventFunction& reached, ModeChange& change) {
  if (here_.state.sliding.empty() || reached.kind != FunctionKind::surface) return false;
  const int slid = here_.state.sliding.front();
  field_(located.t, located.x.data(), here_.slope.data());
  const double selection = field_.alpha()[at(slid)];
  if (!is_finite(here_.slope) || !std::isfinite(selection)) return false;
  here_.state.alpha[at(slid)] = selection;
  SwitchingPoint& both = event_.switching_point;
  Transition& transition = event_.transition;
  both.begin(located.t, located.x.data(), here_.time_scale);
  both.at_zero = {std::min(slid, reached.index), std::max(slid, reached.index)};
  both.touched.assign(1, reached.index);
  const bool is_pair = fast_.pair.look(here_.state, both, &field_);
  if (is_pair) {
    if (const auto across = fast_.pair.across(here_.state, both)) {
      const int behind = -here_.state.mode[at(reached.index)];
      change_surface(reached.index, behind, behind > 0 ? 1.0 : 0.0, switching::reason_of_passage(), change);
      fast_.slid = *across;
      change.slid = &fast_.slid;
      change.beyond = {&constants_beyond(reached.index, 0.0), &constants_beyond(reached.index, 1.0)};
      return true;
    }
  }
  event_.before = here_.state;
  const bool decided = is_pair ? fast_.pair.conclude(event_.before, both, transition)
                               : fast_.single.decide(event_.before, both, transition);
  if (decided) change = transition.from(event_.before);
  return decided;
}

/// Only the mode of this surface is another one behind.
void Run::change_surface(int surface, int mode, double alpha, std::string_view reason, ModeChange& change) const {
  change.surface = surface;
  change.before = here_.state.mode[at(surface)];
  change.after = mode;
  change.alpha_before = here_.state.alpha[at(surface)];
  change.alpha_after = alpha;
  change.reason = reason;
}

/// Those of the region on the other side of a surface, on a side of what is slid on, if anything is.
const evaluation::FieldConstants& Run::constants_beyond(int surface, double side) {
  const auto j = at(surface);
  auto& selections = here_.state.alpha;
  const auto slid = here_.state.sliding.empty() ? j : at(here_.state.sliding.front());
  const double of_slid = std::exchange(selections[slid], side);
  const double own = std::exchange(selections[j], here_.state.mode[j] < 0 ? 1.0 : 0.0);
  const auto& constants = fast_.fields.of(selections, steps_.memory().mark_with(j, -here_.state.mode[j]));
  selections[j] = own;
  selections[slid] = of_slid;
  return constants;
}

/// Goes on behind an ordinary switch. Returns false where the new field is not finite there: it is the one before.
bool Run::go_on_behind(const Located& located, const ModeChange& change) {
  if (!change.is_evaluated) fast_.x = located.x;
  if (!begin_field(change, located.t, fast_.x)) {
    field_.enter(here_.state);
    return false;
  }
  here_.move_to(located.t, change.is_evaluated ? located.x.data() : fast_.x.data());
  rows_.arrive(OutputRows::Arrival::missing);
  recorder_.switched(here_.t, here_.x, change);
  recorder_.row_before(here_.t, located.x, here_.state, recorder_.events() - 1);
  here_.change_mode(change);
  steps_.begin_mode();
  search_.begin(change, here_);
  const auto& selections = here_.state.sliding.empty() ? here_.state.alpha : field_.alpha();
  recorder_.row_behind(here_.x, here_.state, selections, change);
  switches_.series().note(here_.t, change);
  here_.h = steps_.memory().change(here_.state.mode, here_.t, here_.h, change);
  restart_control();
  rows_.skip_here();
  event_.last_time = here_.t;
  if (!too_many_events()) {
    switches_.note(change);
    accumulate_switches();
    if (outcome_.running && !here_.state.sliding.empty()) choices_.watch(field_);
  }
  if (change.is_single() && change.slid == nullptr) keep_step(change.surface);
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

}  // namespace saltus::event_integrator
