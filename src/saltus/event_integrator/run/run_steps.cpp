#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "saltus/event_integrator/decide/sets/without_limit.hpp"
#include "saltus/event_integrator/instant/cell_stage.hpp"
#include "saltus/event_integrator/instant/mass_beyond.hpp"
#include "saltus/event_integrator/mode/undefined.hpp"
#include "saltus/event_integrator/run/run_internal.hpp"

namespace saltus::event_integrator {

using result::Termination;

/// Rows at requested times before t_end, from the dense output of the step under way.
void Run::rows_until(double t_end) {
  const auto& dense = steps_.dense();
  run_.rows.keep(dense, t_end);
  run_.rows.write_before(t_end, [&](double t, double* x) { dense.evaluate((t - dense.t) / dense.h, x); });
}

/// The same for a step whose dense output is undefined (dop853 evaluates three more stages for it), by steps that end
/// at the times; the step itself is then taken once more, so that it does not depend on the rows.
void Run::rows_by_steps(double t_new) {
  const auto& dense = steps_.dense();
  run_.rows.leave_open(t_new);
  run_.rows.write_before(t_new, [&](double t, double* x) {
    if (steps_.take(t) == ode::Attempt::finite) {
      std::copy_n(steps_.stepper().x_new(), run_.here.x.size(), x);
    } else {
      dense.evaluate((t - dense.t) / dense.h, x);
    }
  });
  static_cast<void>(steps_.take(t_new));
}

bool Run::shorten(double factor) {
  ++statistics_.rejected;
  run_.here.h = steps_.length() * factor;
  steps_.set_length(run_.here.h);
  return run_.here.h > run_.here.smallest_step();
}

/// Whether the steps got short because the sliding selection, or the right-hand side itself, has no limit here.
bool Run::stopped_by_two_fold() {
  auto message = two_fold_message(run_.switching, run_.here.state, run_.here.t, run_.here.x.data());
  if (!message)
    message =
        without_limit(run_.switching, run_.here.t, run_.here.x, run_.here.state.alpha, run_.tolerances.mode().atol);
  if (message) run_.end(Termination::outside_class, *message);
  return message.has_value();
}

/// Whether the steps got short because switches accumulate here, because of a two-fold point, of bodies that jam, or of
/// their masses.
bool Run::stopped_by_singularity() {
  auto message = indefinite_mass_beyond(run_);
  if (!message) message = run_.contacts.jam(run_.contact_moment(), run_.here.x);
  if (message) {
    run_.end(Termination::outside_class, std::move(*message));
    return true;
  }
  if (!switches_.series().shrinks(run_.here.t)) return stopped_by_two_fold();
  accumulates();
  return true;
}

/// The states whose right-hand side is undefined a little further along it; empty if none is found.
std::string Run::undefined_beyond() {
  std::vector<double> x = run_.here.x, slope = run_.here.slope;
  for (double h = run_.here.smallest_step(); h <= 1e6 * run_.here.smallest_step(); h *= 4.0) {
    for (std::size_t i = 0; i < x.size(); ++i) x[i] = run_.here.x[i] + h * run_.here.slope[i];
    run_.field(run_.here.t + h, x.data(), slope.data());
    if (!is_finite(slope)) return undefined_states(run_.switching.layout, slope);
  }
  return {};
}

/// The switching function, event or jump that is undefined a little further along the right-hand side, in words; empty
/// if none is found.
std::string Run::undefined_function_beyond() {
  std::vector<double> x = run_.here.x;
  for (double h = run_.here.smallest_step(); h <= 1e6 * run_.here.smallest_step(); h *= 4.0) {
    for (std::size_t i = 0; i < x.size(); ++i) x[i] = run_.here.x[i] + h * run_.here.slope[i];
    const auto& values = zeros_.functions(run_.here.t + h, x.data());
    for (std::size_t i = 0; i < values.size(); ++i) {
      const auto& function = run_.search.functions()[i];
      if (std::isfinite(values[i]) || is_cell_end(function.kind)) continue;
      const bool named = at(function.index) < run_.switching.layout.surfaces.size();
      return named ? fmt::format("the switching function '{}'", run_.switching.layout.surfaces[at(function.index)].name)
                   : std::string("an expression of [[events]] or [[jumps]]");
    }
  }
  return {};
}

Run::Step Run::shorten_to(double factor) {
  if (shorten(factor)) return Step::shortened;
  leave_undefined();
  return Step::taken;
}

/// The right-hand side is undefined however short the step: the region of this field ends here, or the model does.
void Run::leave_undefined() {
  event().rooted = zeros_.root_here_once();
  const double before = run_.here.t;
  if (event().rooted >= 0) leave_root();
  if (run_.here.t > before) return;
  if (auto located = zeros_.beside_undefined()) return come_to(std::move(*located));
  if (stopped_by_singularity()) return;
  const std::string states = undefined_beyond();
  if (!states.empty()) {
    return run_.end(
        Termination::evaluation_failed,
        fmt::format(
            "the right-hand side of {} is not finite beyond {}, however short the step; guard the expression with "
            "if(…), or end the simulation before",
            states, run_.where()));
  }
  if (const std::string function = undefined_function_beyond(); !function.empty()) {
    return run_.end(
        Termination::evaluation_failed,
        fmt::format("{} is not finite beyond {}; guard the expression with if(…), or end the simulation before",
                    function, run_.where()));
  }
  if (hold_unresolved()) return;
  if (const ode::Stages stages = steps_.stepper().stages(); stages != ode::Stages::found) {
    return run_.end(
        Termination::step_size_too_small,
        fmt::format("{} finds no stages beyond {}, however short the step: {}; integrator = \"auto\" goes on "
                    "with explicit steps where that is so, \"dopri5\" takes no others",
                    ode::name(steps_.method()), run_.where(), ode::reason(stages)));
  }
  run_.end(
      Termination::step_size_too_small,
      fmt::format("events cannot be told apart beyond {}, however short the step: a switching function or guard is no "
                  "more than its rounding there (a multiple zero), or changes faster than t is resolved; state it in "
                  "another form",
                  run_.where()));
}

void Run::count_step(double h) {
  ++statistics_.steps;
  steps_.choice().count(steps_.stepper().method(), h);
}

void Run::accept(double t_new) {
  Position& here = run_.here;
  rows_until(t_new);
  const double h = t_new - here.t;
  count_step(h);
  nested_.accepted(h);
  here.move_to(t_new, steps_.stepper().x_new());
  note_time_scale(h);
  steps_.accepted(h);
  const bool projected = run_.field.project(here.t, here.x.data());
  const bool follows = steps_.stepper().follows();
  if (follows) run_.field.prepare();
  const bool held = !run_.jumps.none() && run_.holding.project(here.t, here.state.alpha, here.x);
  if (held || projected || follows) {
    run_.field(here.t, here.x.data(), here.slope.data());
  } else {
    std::copy_n(steps_.stepper().slope_new(), here.slope.size(), here.slope.begin());
  }
  run_.field.follow(here.t, here.x.data());
  limit_beside_coalescence();
  here.h = steps_.proposed(h);
  if (follows) {
    here.h = fast_.local.next_length();
    run_.field.follow_known(nullptr);
  }
  // A step that was cut short at a time of a jump says nothing against the one that was proposed.
  if (here.t < run_.options.until && here.t == run_.jumps.next_time()) here.h = std::max(here.h, steps_.length());
  steps_.memory().accepted(here.h);
  switches_.end_if_over(roots_of_cycles());
  // Where steps are as long as they may be there are none longer.
  const bool watched = h < 0.5 * run_.options.max_step.value_or(std::numeric_limits<double>::infinity());
  steps_.choice().accepted(steps_.stepper(), run_.tolerances.step(), watched);
  if (run_.search.settle(here.t, here.x.data())) resolver_.settle_signs();
  come_to_end_of_step(h);
}

/// What there is at the end of a step that has met nothing: a break at the end of the run, a departure, jumps that are
/// due, and nested zeros ahead.
void Run::come_to_end_of_step(double h) {
  const Position& here = run_.here;
  const bool departs = here.t == choices_.next().departure();
  if (here.t >= run_.options.until && !departs) {
    // Values are continuous from the right at every break, at one that is the end, too.
    if (Located breaks = breaks_here(run_); !breaks.functions.empty()) {
      if (choices_.families().watches()) choices_.look(here.t - h, steps_);
      return come_to(std::move(breaks));
    }
  }
  run_.rows.write_end_of_step();
  if (choices_.families().watches()) choices_.look(here.t - h, steps_);
  if (departs) return leave_later();
  if (run_.jumps.next_time() <= here.t) return come_to(Instant::Cause::due);
  if (nested_.watches() && here.t < run_.options.until) {
    if (auto located = nested_.ahead(next_stop())) arrive_at_nested_roots(std::move(*located));
  }
}

/// An attempt has met points where the right-hand side is undefined: what is there, or a shorter attempt.
Run::Step Run::beside_undefined(double t_new) {
  steps_.note_undefined();
  steps_.choice().failed(steps_.stepper().stages());
  auto located = zeros_.any_ending() ? zeros_.ahead(t_new) : std::nullopt;
  // Not on the way of a long step, which has others to look at.
  constexpr double short_way = 1e3;
  if (!located && t_new - run_.here.t <= short_way * run_.here.smallest_step()) located = zeros_.within_rounding();
  if (!located) return shorten_to(0.25);
  come_to(std::move(*located));
  return Step::taken;
}

Run::Step Run::reject(double error) {
  const double h = steps_.stepper().length();
  if (shorten(steps_.rejected(error))) return Step::shortened;
  if (!stopped_by_singularity()) {
    run_.end(Termination::step_size_too_small,
             fmt::format("the tolerance cannot be reached at {}: the step has fallen to {:.3g}; the solution may blow "
                         "up there, or rtol is below what doubles carry",
                         run_.where(), h));
  }
  return Step::taken;
}

/// The first event of the last attempt, which ends at t_new; nullopt if there is none.
std::optional<Run::Step> Run::first_event(double t_new) {
  // Events must not depend on the rows: where nothing can vanish there is no search, with and without a dense output.
  // A search is as fast where that is there already.
  const bool may_vanish = steps_.stepper().follows() || run_.search.may_vanish(steps_.stepper());
  if (!may_vanish && !run_.rows.any_inside(t_new)) return std::nullopt;
  zeros_.forget();  // the search finds the roundings of functions anew
  if (!steps_.make_dense()) {
    if (may_vanish) return shorten_to(0.5);
    rows_by_steps(t_new);
  }
  if (!may_vanish) return std::nullopt;
  Hit hit;
  const auto location = steps_.stepper().follows() ? EventSearch::Location::along : EventSearch::Location::retaken;
  const auto outcome = run_.search.search(steps_.dense(), location, hit);
  if (outcome == SearchOutcome::none) return std::nullopt;
  if (outcome == SearchOutcome::unresolved) return shorten_to(0.5);
  const Position& here = run_.here;
  const double h = t_new - here.t;
  if (h > 8.0 * here.smallest_step() && steps_.doubts(hit.doubts)) return shorten_to(0.5 * h / steps_.length());
  note_time_scale(h);
  const Located* located = locator_.locate({here.t, here.x.data(), here.slope.data()}, steps_.dense(), hit);
  if (!located || zeros_.is_repelled(*located)) return shorten_to(0.5);
  count_step(located->t - here.t);
  if (run_.rows.asks_for_lines()) run_.rows.write_lines(located->t, steps_.dense());
  // A requested time that is a break but for its rounding belongs to the cell behind it.
  const bool ends_cell = reaches_cell_end(run_.search, *located);
  rows_until(ends_cell ? located->t - time_rounding(located->t) : located->t);
  come_to(*located);
  return Step::taken;
}

/// One attempt at a step: undefined, too inaccurate, up to an event, or accepted.
Run::Step Run::attempt() {
  if (steps_.uses_another()) choose_method();
  const double limit = next_stop();
  const bool to_the_limit = run_.here.t + steps_.length() * (1.0 + 4.0 * rounding_unit) >= limit;
  const double t_new = to_the_limit ? limit : run_.here.t + steps_.length();
  limit_beside_zeros(t_new - run_.here.t);
  if (steps_.take(t_new) == ode::Attempt::undefined) return beside_undefined(t_new);
  steps_.follow_method();
  if (const double error = steps_.confirmed_error(); !(error <= 1.0)) return reject(error);
  if (const auto step = first_event(t_new)) return *step;
  if (run_.rows.asks_for_lines() && run_.rows.may_bend(steps_.stepper()) && steps_.make_dense()) {
    run_.rows.write_lines(t_new, steps_.dense());
  }
  accept(t_new);
  return Step::taken;
}

}  // namespace saltus::event_integrator
