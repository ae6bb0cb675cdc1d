#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "saltus/evaluation/explanations.hpp"
#include "saltus/event_integrator/decide/sets/without_limit.hpp"
#include "saltus/event_integrator/mode/at_surface.hpp"
#include "saltus/event_integrator/mode/undefined.hpp"
#include "saltus/event_integrator/run/run_internal.hpp"

namespace saltus::event_integrator {

using result::Termination;

/// Rows at requested times before t_end, from the dense output of the step under way.
void Run::rows_until(double t_end) {
  const auto& dense = steps_.dense();
  rows_.keep(dense, t_end);
  rows_.write_before(t_end, [&](double t, double* x) { dense.evaluate((t - dense.t) / dense.h, x); });
}

/// The same for a step whose dense output is undefined (dop853 evaluates three more stages for it), by steps that end
/// at the times; the step itself is then taken once more, so that it does not depend on the rows.
void Run::rows_by_steps(double t_new) {
  const auto& dense = steps_.dense();
  rows_.leave_open(t_new);
  rows_.write_before(t_new, [&](double t, double* x) {
    if (steps_.take(t) == ode::Attempt::finite) {
      std::copy_n(steps_.stepper().x_new(), here_.x.size(), x);
    } else {
      dense.evaluate((t - dense.t) / dense.h, x);
    }
  });
  static_cast<void>(steps_.take(t_new));
}

bool Run::shorten(double factor) {
  ++outcome_.result.statistics.rejected;
  here_.h = steps_.length() * factor;
  steps_.set_length(here_.h);
  return here_.h > here_.smallest_step();
}

/// Whether the steps got short because the sliding selection, or the right-hand side itself, has no limit here.
bool Run::stopped_by_two_fold() {
  auto message = two_fold_message(switching_context_, here_.state, here_.t, here_.x.data());
  if (!message)
    message = without_limit(switching_context_, here_.t, here_.x, here_.state.alpha, tolerances_.mode().atol);
  if (message) fail(Termination::outside_class, *message);
  return message.has_value();
}

/// Whether the steps got short because the mass matrix is positive definite up to here only.
bool Run::stopped_by_mass() {
  std::vector<double> x = here_.x;
  for (double h = here_.smallest_step(); h <= 1e6 * here_.smallest_step(); h *= 4.0) {
    for (std::size_t i = 0; i < x.size(); ++i) x[i] = here_.x[i] + h * here_.slope[i];
    const auto row = evaluation::find_indefinite_mass(kernel_, x);
    if (!row) continue;
    fail(Termination::outside_class,
         fmt::format("the mass matrix is not positive definite beyond {}: {}; every velocity needs a positive mass or "
                     "inertia wherever the bodies get",
                     where(), *row));
    return true;
  }
  return false;
}

/// Whether the steps got short because switches accumulate here, because of a two-fold point, of bodies that jam, or of
/// their masses.
bool Run::stopped_by_singularity() {
  if (stopped_by_mass()) return true;
  if (auto jam = contacts_.jam(contact_moment(), here_.x)) {
    fail(Termination::outside_class, std::move(*jam));
    return true;
  }
  if (!switches_.series().shrinks(here_.t)) return stopped_by_two_fold();
  accumulates();
  return true;
}

/// The states whose right-hand side is undefined a little further along it; empty if none is found.
std::string Run::undefined_beyond() {
  std::vector<double> x = here_.x, slope = here_.slope;
  for (double h = here_.smallest_step(); h <= 1e6 * here_.smallest_step(); h *= 4.0) {
    for (std::size_t i = 0; i < x.size(); ++i) x[i] = here_.x[i] + h * here_.slope[i];
    field_(here_.t + h, x.data(), slope.data());
    if (!is_finite(slope)) return undefined_states(switching_context_.layout, slope);
  }
  return {};
}

/// The switching function, event or jump that is undefined a little further along the right-hand side, in words; empty
/// if none is found.
std::string Run::undefined_function_beyond() {
  std::vector<double> x = here_.x;
  for (double h = here_.smallest_step(); h <= 1e6 * here_.smallest_step(); h *= 4.0) {
    for (std::size_t i = 0; i < x.size(); ++i) x[i] = here_.x[i] + h * here_.slope[i];
    const auto& values = zeros_.functions(here_.t + h, x.data());
    for (std::size_t i = 0; i < values.size(); ++i) {
      const auto& function = search_.functions()[i];
      if (std::isfinite(values[i]) || is_cell_end(function.kind)) continue;
      const bool named = at(function.index) < switching_context_.layout.surfaces.size();
      return named ? fmt::format("the switching function '{}'",
                                 switching_context_.layout.surfaces[at(function.index)].name)
                   : std::string("an expression of [[events]] or [[jumps]]");
    }
  }
  return {};
}

/// The right-hand side is undefined however short the step: the region of this field ends here, or the model does.
Run::Step Run::undefined_step() {
  event_.rooted = zeros_.root_here_once();
  const double before = here_.t;
  if (event_.rooted >= 0) leave_root();
  if (here_.t > before) return outcome_.running ? Step::taken : Step::failed;
  if (const auto located = zeros_.beside_undefined()) return handle(*located);
  if (stopped_by_singularity()) return Step::failed;
  const std::string states = undefined_beyond();
  const std::string function = states.empty() ? undefined_function_beyond() : std::string();
  if (!function.empty()) {
    fail(Termination::evaluation_failed,
         fmt::format("{} is not finite beyond {}; guard the expression with if(…), or end the simulation before",
                     function, where()));
    return Step::failed;
  }
  if (states.empty()) {
    if (hold_unresolved()) return outcome_.running ? Step::taken : Step::failed;
    fail(Termination::step_size_too_small,
         fmt::format(
             "events cannot be told apart beyond {}, however short the step: a switching function or guard is no "
             "more than its rounding there (a multiple zero), or changes faster than t is resolved; state it in "
             "another form",
             where()));
    return Step::failed;
  }
  fail(Termination::evaluation_failed,
       fmt::format(
           "the right-hand side of {} is not finite beyond {}, however short the step; guard the expression with "
           "if(…), or end the simulation before",
           states, where()));
  return Step::failed;
}

Run::Step Run::accept(double t_new) {
  ++outcome_.result.statistics.steps;
  rows_until(t_new);
  const double h = t_new - here_.t;
  nested_.accepted(h);
  here_.move_to(t_new, steps_.stepper().x_new());
  note_time_scale(h);
  steps_.accepted(h);
  const bool projected = field_.project(here_.t, here_.x.data());
  const bool follows = steps_.stepper().follows();
  if (follows) field_.prepare();
  if (holding_.project(here_.t, here_.state.alpha, here_.x) || projected || follows) {
    field_(here_.t, here_.x.data(), here_.slope.data());
  } else {
    std::copy(steps_.stepper().slope_new(), steps_.stepper().slope_new() + here_.slope.size(), here_.slope.begin());
  }
  field_.follow(here_.t, here_.x.data());
  limit_beside_coalescence();
  here_.h = steps_.proposed(h);
  if (follows) {
    here_.h = fast_.local.next_length();
    field_.follow_known(nullptr);
  }
  // A step that was cut short at a time of a jump says nothing against the one that was proposed.
  if (here_.t < options_.until && here_.t == jumps_.next_time()) here_.h = std::max(here_.h, steps_.length());
  steps_.memory().accepted(here_.h);
  switches_.end_if_over(roots_of_cycles());
  // Where steps are as long as they may be there are none longer.
  if (h < 0.5 * options_.max_step.value_or(std::numeric_limits<double>::infinity())) steps_.watch_stiffness();
  if (search_.settle(here_.t, here_.x.data())) {
    // What a user function turns to from a zero at the start is its first sign, not a change of it.
    static_cast<void>(user_events_.update(here_.t, here_.x.data(), here_.state.alpha, search_.user_signs()));
    cascade_.begin();
    jumps_.update(jump_point());
  }
  if (here_.t >= options_.until && here_.t != choices_.next().departure()) {
    // Values are continuous from the right at every break, at one that is the end, too.
    if (const Located breaks = breaks_here(); !breaks.functions.empty()) {
      if (choices_.families().watches()) choices_.look(here_.t - h, steps_);
      return handle(breaks);
    }
  }
  rows_.write_end_of_step();
  if (choices_.families().watches()) choices_.look(here_.t - h, steps_);
  if (here_.t == choices_.next().departure()) return leave_later();
  if (jumps_.next_time() <= here_.t) return jump_in_time();
  if (nested_.watches() && here_.t < options_.until) {
    if (const auto located = nested_.ahead(next_stop())) return arrive_at_nested_roots(*located);
  }
  return Step::taken;
}

/// An attempt has met points where the right-hand side is undefined: what is there, or a shorter attempt.
Run::Step Run::beside_undefined(double t_new) {
  steps_.note_undefined();
  if (zeros_.any_ending()) {
    if (const auto located = zeros_.ahead(t_new)) return handle(*located);
  }
  // Not on the way of a long step, which has others to look at.
  if (t_new - here_.t <= 1e3 * here_.smallest_step()) {
    if (const auto located = zeros_.within_rounding()) return handle(*located);
  }
  return shorten_to(0.25);
}

Run::Step Run::reject(double error) {
  const double h = steps_.stepper().length();
  if (shorten(steps_.rejected(error))) return Step::shortened;
  if (stopped_by_singularity()) return Step::failed;
  fail(Termination::step_size_too_small,
       fmt::format("the tolerance cannot be reached at {}: the step has fallen to {:.3g}; the solution may blow up "
                   "there, or rtol is below what doubles carry",
                   where(), h));
  return Step::failed;
}

/// The first event of the last attempt, which ends at t_new; nullopt if there is none.
std::optional<Run::Step> Run::first_event(double t_new) {
  // Events must not depend on the rows: where nothing can vanish there is no search, with and without a dense output.
  // A search is as fast where that is there already.
  const bool may_vanish = steps_.stepper().follows() || search_.may_vanish(steps_.stepper());
  if (!may_vanish && !rows_.any_inside(t_new)) return std::nullopt;
  zeros_.forget();  // the search finds the roundings of functions anew
  if (!steps_.make_dense()) {
    if (may_vanish) return shorten_to(0.5);
    rows_by_steps(t_new);
  }
  if (!may_vanish) return std::nullopt;
  Hit hit;
  const auto location = steps_.stepper().follows() ? EventSearch::Location::along : EventSearch::Location::retaken;
  const auto outcome = search_.search(steps_.dense(), location, hit);
  if (outcome == SearchOutcome::none) return std::nullopt;
  if (outcome == SearchOutcome::unresolved) return shorten_to(0.5);
  const double h = t_new - here_.t;
  if (h > 8.0 * here_.smallest_step() && steps_.doubts(hit.doubts)) return shorten_to(0.5 * h / steps_.length());
  note_time_scale(t_new - here_.t);
  const Located* located = locator_.locate({here_.t, here_.x.data(), here_.slope.data()}, steps_.dense(), hit);
  if (!located || zeros_.is_repelled(*located)) return shorten_to(0.5);
  ++outcome_.result.statistics.steps;
  if (rows_.asks_for_lines()) rows_.write_lines(located->t, steps_.dense());
  // A requested time that is a break but for its rounding belongs to the cell behind it.
  rows_until(reaches_cell_end(*located) ? located->t - 4.0 * rounding_unit * std::abs(located->t) : located->t);
  return handle(*located);
}

/// One attempt at a step: undefined, too inaccurate, up to an event, or accepted.
Run::Step Run::attempt() {
  if (steps_.uses_another()) choose_method();
  const double limit = next_stop();
  const bool to_the_limit = here_.t + steps_.length() * (1.0 + 4.0 * rounding_unit) >= limit;
  const double t_new = to_the_limit ? limit : here_.t + steps_.length();
  limit_beside_zeros(t_new - here_.t);
  if (steps_.take(t_new) == ode::Attempt::undefined) return beside_undefined(t_new);
  steps_.follow_method();
  if (const double error = steps_.confirmed_error(); !(error <= 1.0)) return reject(error);
  if (const auto step = first_event(t_new)) return *step;
  if (rows_.asks_for_lines() && rows_.may_bend(steps_.stepper()) && steps_.make_dense()) {
    rows_.write_lines(t_new, steps_.dense());
  }
  return accept(t_new);
}

}  // namespace saltus::event_integrator
