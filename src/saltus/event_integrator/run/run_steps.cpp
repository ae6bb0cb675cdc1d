#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "saltus/event_integrator/decide/sets/without_limit.hpp"
#include "saltus/event_integrator/mode/at_surface.hpp"
#include "saltus/event_integrator/mode/undefined.hpp"
#include "saltus/event_integrator/run/run_internal.hpp"

namespace saltus::event_integrator {

using result::Termination;

void Run::row(double t, const std::vector<double>& x) {
  if (!state_.sliding.empty()) field_(t, x.data(), row_slope_.data());
  recorder_.row(t, x, state_, state_.sliding.empty() ? state_.alpha : field_.alpha());
}

/// Rows at requested times in (t_, t_end), from the dense output of the step under way.
void Run::rows_until(double t_end) {
  const auto& times = options_.output.times;
  for (; next_output_ < times.size() && times[next_output_] <= t_end; ++next_output_) {
    const double t = times[next_output_];
    if (t <= t_ || t == t_end) {
      if (t == t_end) break;
      continue;
    }
    dense_.evaluate((t - dense_.t) / dense_.h, row_x_.data());
    row_inside(t);
  }
}

/// The row of row_x_, not yet on the surfaces of the mode.
void Run::row_inside(double t) {
  field_.project(t, row_x_.data());
  static_cast<void>(holding_.project(t, state_.alpha, row_x_));
  row(t, row_x_);
}

/// The same for a step whose dense output is undefined (dop853 evaluates three more stages for it), by steps that end
/// at the times; the step itself is then taken once more, so that it does not depend on the rows.
void Run::rows_by_steps(double t_new) {
  const auto& times = options_.output.times;
  const auto take = [&](double t) {
    return field_.attempt(stepper_, t_, x_.data(), slope_.data(), t - t_, tolerances_);
  };
  for (; next_output_ < times.size() && times[next_output_] < t_new; ++next_output_) {
    const double t = times[next_output_];
    if (t <= t_) continue;
    if (take(t) == ode::Attempt::finite) {
      std::copy_n(stepper_.x_new(), row_x_.size(), row_x_.begin());
    } else {
      dense_.evaluate((t - dense_.t) / dense_.h, row_x_.data());
    }
    row_inside(t);
  }
  static_cast<void>(take(t_new));
}

bool Run::shorten(double factor) {
  ++result_.statistics.rejected;
  h_try_ *= factor;
  h_ = h_try_;
  if (h_try_ > smallest_step()) return true;
  return false;
}

/// Whether the steps got short because the sliding selection, or the right-hand side itself, has no limit here.
bool Run::stopped_by_two_fold() {
  auto message = two_fold_message(surroundings_, state_, t_, x_.data());
  if (!message) message = without_limit(surroundings_, t_, x_, state_.alpha, mode_tolerances_.atol);
  if (message) fail(Termination::outside_class, *message);
  return message.has_value();
}

/// Whether the steps got short because switches accumulate here, or because of a two-fold point.
bool Run::stopped_by_singularity() {
  if (!series_.shrinks(t_)) return stopped_by_two_fold();
  accumulates();
  return true;
}

/// The states whose right-hand side is undefined a little further along it; empty if none is found.
std::string Run::undefined_beyond() {
  for (double h = smallest_step(); h <= 1e6 * smallest_step(); h *= 4.0) {
    for (std::size_t i = 0; i < x_.size(); ++i) row_x_[i] = x_[i] + h * slope_[i];
    field_(t_ + h, row_x_.data(), row_slope_.data());
    if (!is_finite(row_slope_)) return undefined_states(surroundings_.system, row_slope_);
  }
  return {};
}

/// Values of all functions that are searched.
std::vector<double> Run::all_functions(double t, const double* x) {
  std::vector<double> values;
  find_functions(t, x, values);
  return values;
}

void Run::find_functions(double t, const double* x, std::vector<double>& values) {
  all_searched_.resize(search_.functions().size());
  std::iota(all_searched_.begin(), all_searched_.end(), std::size_t{0});
  search_.evaluate(t, x, all_searched_, values);
}

/// The switching function, event or jump that is undefined a little further along the right-hand side, in words; empty
/// if none is found.
std::string Run::undefined_function_beyond() {
  for (double h = smallest_step(); h <= 1e6 * smallest_step(); h *= 4.0) {
    for (std::size_t i = 0; i < x_.size(); ++i) row_x_[i] = x_[i] + h * slope_[i];
    const std::vector<double> values = all_functions(t_ + h, row_x_.data());
    for (std::size_t i = 0; i < values.size(); ++i) {
      const auto& function = search_.functions()[i];
      if (std::isfinite(values[i]) || is_cell_end(function.kind)) continue;
      const bool named = at(function.index) < surroundings_.system.switching.size();
      return named ? fmt::format("the switching function '{}'", surroundings_.system.switching[at(function.index)].name)
                   : std::string("an expression of [[events]] or [[jumps]]");
    }
  }
  return {};
}

/// A surface that the state cannot come nearer to, as its next digit is on it or behind it, although time could go on:
/// steps that change nothing succeed there, and all others are undefined.
std::optional<Located> Run::surface_within_rounding() {
  auto& values = values_here_;
  find_functions(t_, x_.data(), values);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto& function = search_.functions()[i];
    if (function.kind != FunctionKind::surface || !(std::abs(values[i]) <= search_.noise(i))) continue;
    const Rate rate = rate_along_field(function.index, t_, x_.data(), slope_.data());
    constexpr double rounding = 1e-12;  // a surface that was left tangentially is none
    if (!(function.sign * rate.value < -rounding * rate.terms)) continue;
    Located located{t_, x_, {i}, {function.sign}};
    move_onto(kernel_, state_, function.index, t_, located.x);
    return located;
  }
  return std::nullopt;
}

/// Whether a surface that no step gets to is one that its own field leads away from: beside a root of psi a dense
/// output dips below zero where the solution only comes near.
bool Run::is_repelled(const Located& located) {
  const auto& function = search_.functions()[located.functions.front()];
  if (!located.short_of || function.kind != FunctionKind::surface) return false;
  row_x_ = located.x;
  move_onto(kernel_, state_, function.index, located.t, row_x_);
  field_(located.t, row_x_.data(), row_slope_.data());
  const Rate rate = rate_along_field(function.index, located.t, row_x_.data(), row_slope_.data());
  constexpr double rounding = 1e-12;
  return located.signs.front() * rate.value > rounding * rate.terms;
}

/// The right-hand side is undefined however short the step: the region of this field ends here, or the model does.
Run::Step Run::undefined_step() {
  if (t_ != root_tried_at_) {
    root_tried_at_ = t_;
    rooted_ = root_here();
    const double before = t_;
    if (rooted_ >= 0) leave_root();
    if (t_ > before) return running_ ? Step::taken : Step::failed;
  }
  auto& values = values_here_;
  find_functions(t_, x_.data(), values);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto& function = search_.functions()[i];
    const bool surface = function.kind == FunctionKind::surface;
    if (!surface && function.kind != FunctionKind::loss) continue;
    // The zero lies within the time that can no longer be resolved, or the selection has become double.
    const double rate = surface ? rate_along_field(function.index, t_, x_.data(), slope_.data()).value : 0.0;
    // NOTE: the last step may have ended at 0 itself, or a rounding beyond it.
    const bool ahead = function.sign * rate < 0.0 || (function.sign == 0 && values[i] * rate < 0.0);
    // Of sqrt(x) + 1 the rate is infinite at x = 0, and nothing is reached.
    const bool is_near = std::isfinite(rate) && std::abs(values[i] / rate) <= 1e3 * smallest_step();
    const bool reached = surface ? ahead && is_near : std::abs(values[i]) < 1e-3;
    if (reached) {
      Located located{t_, x_, {i}, {function.sign}};
      if (surface) move_onto(kernel_, state_, function.index, t_, located.x);
      return handle(located);
    }
  }
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
    if (hold_what_drowns()) return running_ ? Step::taken : Step::failed;
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
  ++result_.statistics.steps;
  rows_until(t_new);
  const double h = t_new - t_;
  if (!nearing_.empty()) {
    nearing_slope_ = slope_;
    nearing_step_ = h;
  }
  std::copy(stepper_.x_new(), stepper_.x_new() + x_.size(), x_.begin());
  t_ = t_new;
  note_time_scale(h);
  longest_step_ = std::max(longest_step_, h);
  last_step_ = h;
  const bool projected = field_.project(t_, x_.data());
  if (holding_.project(t_, state_.alpha, x_) || projected) {
    field_(t_, x_.data(), slope_.data());
  } else {
    std::copy(stepper_.slope_new(), stepper_.slope_new() + slope_.size(), slope_.begin());
  }
  field_.follow(t_, x_.data());
  follow_roots();
  h_ = h * control_.accepted(error_norm());
  // A step that was cut short at a time of a jump says nothing against the one that was proposed.
  if (t_ < options_.until && t_ == jumps_.next_time()) h_ = std::max(h_, h_try_);
  step_memory_.accepted(h_);
  if (lap_share_ != 1.0) end_shrinking();
  if (!stiff_at_ && stiffness_.looks_stiff(stepper_)) stiff_at_ = t_;
  if (search_.settle(t_, x_.data())) {
    // What a user function turns to from a zero at the start is its first sign, not a change of it.
    static_cast<void>(user_events_.update(t_, x_.data(), state_.alpha, search_.user_signs()));
    jumps_.update(jump_point());
  }
  if (t_ >= options_.until && t_ != next_choice().departure()) {
    // Values are continuous from the right at every break, at one that is the end, too.
    if (const Located breaks = breaks_here(); !breaks.functions.empty()) {
      if (families_.watches()) look_for_families(t_ - h);
      return handle(breaks);
    }
  }
  const bool requested = next_output_ < options_.output.times.size() && options_.output.times[next_output_] == t_;
  if (requested) ++next_output_;
  if (options_.output.rows == OutputTimes::Rows::at_steps || requested || t_ >= options_.until) row(t_, x_);
  if (families_.watches()) look_for_families(t_ - h);
  if (t_ == next_choice().departure()) return leave_later();
  if (jumps_.next_time() <= t_) return jump_in_time();
  if (!nearing_.empty() && t_ < options_.until) {
    if (const auto located = nested_roots_ahead()) return arrive_at_nested_roots(*located);
  }
  return Step::taken;
}

/// h |f - dx/dt| of the dense output in the middle of the last attempt, in units of the local tolerance; 0 where that
/// is not defined. The error of the step is about the integral of f - dx/dt over it.
double Run::defect() {
  if (stepper_.dense(right_hand_side(), dense_) == ode::Attempt::undefined) return 0.0;
  dense_is_last_ = true;
  constexpr double middle = 0.5;
  dense_.evaluate(middle, row_x_.data());
  dense_.derivative(middle, dense_slope_.data());
  field_(dense_.t + middle * dense_.h, row_x_.data(), row_slope_.data());
  double largest = 0.0;
  for (const std::size_t i : continuous_) {
    const double size = std::max(std::abs(x_[i]), std::abs(stepper_.x_new()[i]));
    const double tolerance = std::max(tolerances_.atol + tolerances_.rtol * size, std::numeric_limits<double>::min());
    const double part = std::abs(dense_.h * (row_slope_[i] - dense_slope_[i])) / tolerance;
    if (std::isfinite(part)) largest = std::max(largest, part);
  }
  return largest;
}

/// Whether the last attempt is far longer than the step before it in its mode. The estimate of that one must have been
/// far below the tolerance: one that passes through zero there may do so again.
bool Run::leaps() const {
  constexpr double far = 1.5;
  return last_step_ > 0.0 && stepper_.length() > far * last_step_;
}

/// The error norm of the last attempt. The first step of a new mode has the length that was right for another field, or
/// a fifth of it, and so on: of very many such lengths, far too long ones, some have an estimate that passes through
/// zero. So it is looked at twice. Of 33 000 steps of random systems that were long enough for their estimate to matter
/// 999 of 1000 had a defect below 55; steps that were wrong by 12 to 700 had 52 to 50 000.
double Run::confirmed_error() {
  const double error = error_norm();
  // The dense output of the other ones is the method; all terms of a series that are neglected follow from the last.
  const bool has_estimate = stepper_.method() != ode::Method::radau5 && stepper_.method() != ode::Method::taylor;
  if (!(error <= 1.0) || !has_estimate || !(step_memory_.is_guess() || leaps())) return error;
  constexpr double believed = 25.0;
  return std::max(error, defect() / believed);
}

Run::Step Run::attempt() {
  // Times of jumps are hit exactly, like the end.
  const double limit = std::min({options_.until, jumps_.next_time(), next_departure()});
  const bool to_the_limit = t_ + h_try_ * (1.0 + 4.0 * rounding_unit) >= limit;
  const double t_new = to_the_limit ? limit : t_ + h_try_;
  const double h = t_new - t_;
  dense_is_last_ = false;
  if (!continued_roots_.empty() || !nearing_.empty() || (!switch_laps_.empty() && !ending_roots_.empty())) {
    tighten_beside_roots(h);
  }
  if (field_.attempt(stepper_, t_, x_.data(), slope_.data(), h, tolerances_) == ode::Attempt::undefined) {
    undefined_ahead_ = true;
    if (!ending_roots_.empty()) {
      if (const auto located = rooted_surface_ahead(t_new)) return handle(*located);
    }
    // Not on the way of a long step, which has others to look at.
    if (h <= 1e3 * smallest_step() && no_surface_at_ != t_) {
      if (const auto located = surface_within_rounding()) return handle(*located);
      no_surface_at_ = t_;
    }
    return shorten(0.25) ? Step::shortened : undefined_step();
  }
  control_.follow(stepper_.method());
  if (const double error = confirmed_error(); !(error <= 1.0)) {
    if (shorten(control_.rejected(error))) return Step::shortened;
    if (stopped_by_singularity()) return Step::failed;
    fail(Termination::step_size_too_small,
         fmt::format("the tolerance cannot be reached at {}: the step has fallen to {:.3g}; the solution may blow up "
                     "there, or rtol is below what doubles carry",
                     where(), h));
    return Step::failed;
  }
  const bool rows_inside = next_output_ < options_.output.times.size() && options_.output.times[next_output_] < t_new;
  // Events must not depend on the rows: where nothing can vanish there is no search, with and without a dense output.
  const bool may_vanish = search_.may_vanish(stepper_);
  if (may_vanish || rows_inside) {
    no_surface_at_.reset();  // the search finds the roundings of functions anew
    if (!dense_is_last_ && stepper_.dense(right_hand_side(), dense_) == ode::Attempt::undefined) {
      if (may_vanish) return shorten(0.5) ? Step::shortened : undefined_step();
      rows_by_steps(t_new);
    } else {
      dense_is_last_ = true;
    }
    Hit hit;
    switch (may_vanish ? search_.search(dense_, hit) : SearchOutcome::none) {
      case SearchOutcome::none:
        break;
      case SearchOutcome::unresolved:
        return shorten(0.5) ? Step::shortened : undefined_step();
      case SearchOutcome::hit: {
        const StepStart start{t_, x_.data(), slope_.data()};
        note_time_scale(h);
        const Located* located = locator_.locate(start, dense_, hit);
        if (!located || is_repelled(*located)) return shorten(0.5) ? Step::shortened : undefined_step();
        ++result_.statistics.steps;
        // A requested time that is a break but for its rounding belongs to the cell behind it.
        if (line_rows_) rows_between_steps(located->t);
        rows_until(reaches_cell_end(*located) ? located->t - 4.0 * rounding_unit * std::abs(located->t) : located->t);
        return handle(*located);
      }
    }
  }
  if (line_rows_ && may_bend()) {
    if (dense_is_last_ || stepper_.dense(right_hand_side(), dense_) == ode::Attempt::finite) rows_between_steps(t_new);
  }
  return accept(t_new);
}

}  // namespace saltus::event_integrator
