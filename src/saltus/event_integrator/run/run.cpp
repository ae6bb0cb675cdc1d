#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "saltus/base/contains.hpp"
#include "saltus/event_integrator/mode/regions.hpp"
#include "saltus/event_integrator/mode/undefined.hpp"
#include "saltus/event_integrator/run/run_internal.hpp"
#include "saltus/event_integrator/steps/thin_layers.hpp"

namespace saltus::event_integrator {

using result::Termination;

Run::Run(evaluation::ModelKernel& kernel, const IntegrationOptions& options, Way way)
    : kernel_(kernel),
      options_(options),
      switching_context_{kernel, kernel.layout().affine_in_selections, options.selection, options.scaling},
      field_(kernel, switching_context_.affine_in_alpha),
      here_(options.from, kernel.initial_state()),
      tolerances_(options.tolerances),
      steps_(options, kernel.layout(), field_, here_, tolerances_),
      cells_(kernel),
      search_(kernel, field_, options.method, tolerances_.step()),
      zeros_(switching_context_, here_, field_, search_),
      nested_(kernel, here_, search_, tolerances_, zeros_),
      switches_(switching_context_, here_, options.until - options.from, tolerances_),
      locator_(kernel.states(), steps_.stepper(), field_, search_, tolerances_.step()),
      fast_(switching_context_, options, tolerances_),
      user_events_(kernel),
      jumps_(kernel, options.from),
      contacts_(kernel),
      holding_(kernel),
      cascade_(switching_context_, here_, field_, search_, jumps_, contacts_, holding_),
      jump_accumulation_(switching_context_, here_),
      recorder_(kernel),
      rows_(kernel, options, here_, field_, holding_, recorder_),
      choices_(switching_context_, options, here_, recorder_),
      outcome_{.evaluations_before = kernel.field_evaluations()} {
  holding_.keep(&contacts_);
  fast_.applies = way == Way::fast_where_ordinary && has_ordinary_switches();
}

std::string Run::where() const {
  std::string text;
  for (const int j : here_.state.sliding) {
    text += (text.empty() ? "" : ", ") + switching_context_.layout.surfaces[at(j)].name;
  }
  return fmt::format("t = {:.17g}{}", here_.t, text.empty() ? "" : " while sliding on " + text);
}

std::span<const double> Run::shown_state() const {
  const std::span<const double> all(here_.x);
  return all.first(at(switching_context_.layout.shown_states));
}

void Run::fail(Termination termination, std::string message) {
  outcome_.result.status.termination = termination;
  outcome_.result.status.message = std::move(message);
  outcome_.running = false;
}

/// Begins the field of the mode behind a change at a point that it moves onto the surfaces of that; false where it is
/// not finite there. here_.slope is that of the point.
bool Run::begin_field(const ModeChange& change, double t, std::vector<double>& x) {
  field_.begin(change);
  if (change.is_evaluated) return true;
  field_.project(t, x.data());
  field_(t, x.data(), here_.slope.data());
  return is_finite(here_.slope);
}

/// The state that a projection onto the surfaces of the mode has moved farther than errors of steps do, from where it
/// was met; -1 if there is none. Behind a jump of a surface nothing is projected.
int Run::state_moved_from(const std::vector<double>& met) const {
  const auto& [rtol, atol] = options_.tolerances;
  constexpr double many = 1e4;
  // Of a state: what is located at roots, one inside the other, is known to a few digits.
  const double share = std::clamp(many * rtol, 1e-2, 0.1);
  for (std::size_t i = 0; i < met.size(); ++i) {
    const double size = std::max(std::abs(met[i]), std::abs(here_.x[i]));
    if (std::abs(here_.x[i] - met[i]) > many * atol + share * size) return static_cast<int>(i);
  }
  return -1;
}

bool Run::enter(const Transition& transition) {
  const ModeChange change = transition.from(event_.before);
  here_.change_mode(change);
  zeros_.forget();
  set_references(kernel_, here_.state);
  tolerances_.begin_mode(kernel_, options_.layers, here_);
  tolerances_.lift(StepTolerances::Reason::local);
  if (nested_.begin_mode()) tolerances_.lift(StepTolerances::Reason::zeros);
  steps_.begin_mode();
  const std::vector<double> met = here_.x;
  if (!begin_field(change, here_.t, here_.x) && !transition.beside.empty()) {
    // The field is undefined on the far side of its own surface, where rounding has put the state.
    here_.move_to(here_.t, transition.beside.data());
    field_(here_.t, here_.x.data(), here_.slope.data());
  }
  if (!is_finite(here_.slope)) {
    if (stopped_by_mass()) return false;
    fail(
        Termination::evaluation_failed,
        fmt::format("the right-hand side of {} is not finite at {}; change the initial values, or guard the expression "
                    "with if(…)",
                    undefined_states(switching_context_.layout, here_.slope), where()));
    return false;
  }
  if (const int moved = state_moved_from(met); moved >= 0) {
    const double there = std::exchange(here_.x, met)[at(moved)];
    fail(
        Termination::outside_class,
        fmt::format("sliding on from {} would need {} to jump from {:.6g} to {:.6g}: a switching function that is slid "
                    "on jumps there, and the continuation is not decided",
                    where(), switching_context_.layout.state_names[at(moved)], met[at(moved)], there));
    return false;
  }
  search_.begin(change, here_);
  event_.spiral = transition.beyond_spiral;
  event_.rooted = transition.rooted;
  return true;
}

/// Over the first cycle of a spiral that leaves an intersection, which is too small to be seen.
void Run::begin_spiral() {
  const SpiralStart start = *std::exchange(event_.spiral, std::nullopt);
  const double t_new = std::min(here_.t + start.duration, options_.until);
  rows_.each_until(here_.t, t_new, [&](double t) { rows_.write(t, start.x); });
  here_.move_to(t_new, start.x.data());
  Transition beyond;
  beyond.state = here_.state;
  beyond.zero_order.assign(here_.state.mode.size(), 0);
  beyond.zero_order[at(start.surface)] = 1;
  if (!enter(beyond)) return;
  if (rows_.at_steps()) row(here_.t, here_.x);
}

/// The start is an event where jumps are due, or something listed is at zero.
void Run::record_start(const Start& start) {
  row(here_.t, here_.x);
  auto listed = start.at_zero;
  for (const auto& [surface, mode] : options_.initial_mode) {
    if (!contains(listed, surface)) listed.push_back(surface);
  }
  auto transition = start.transition;
  transition.state = here_.state;
  if (!cascade_.executed().empty()) {
    recorder_.jumped(here_.t, cascade_.executed().items(), nullptr, cascade_.transition());
    if (!cascade_.resting().empty()) {
      recorder_.accumulated(here_.t, cascade_.resting(), {here_.x, here_.x, here_.state, here_.state}, resting_reason);
    }
    event_.last_time = here_.t;
  } else if (!listed.empty() && recorder_.started(here_.t, here_.x, transition, listed))
    row(here_.t, here_.x);
}

bool Run::begin() {
  here_.time_scale = 1e-3 * span();
  if (!is_finite(here_.x)) {
    fail(Termination::evaluation_failed,
         fmt::format("the initial value of {} is not finite", undefined_states(switching_context_.layout, here_.x)));
    return false;
  }
  if (!cells_.empty())
    cells_.locate(here_.t, here_.x.data(), std::vector<double>(at(kernel_.switching_functions()), 0.5));
  cascade_.begin();
  if (!begin_jumps()) {
    recorder_.row(here_.t, here_.x, here_.state, here_.state.alpha);
    return false;
  }
  RestingSurfaces resting;
  if (!contacts_.none()) static_cast<void>(find_resting(resting));  // no guard is held yet, which has problems
  const auto decided = [&] {
    return decide_start(switching_context_, here_.t, here_.x.data(), here_.time_scale, options_.initial_mode, resting);
  };
  auto start = decided();
  // At a break the field says into which cell the solution moves, and the cells say what the field is.
  for (int pass = 0; pass < 4 && !cells_.empty(); ++pass) {
    if (start.transition.termination != Termination::completed) break;
    if (cells_.locate(here_.t, here_.x.data(), start.transition.state.alpha) == CellChange::none) break;
    start = decided();
  }
  here_.change_mode(start.transition.state);
  if (here_.state.mode.empty() && kernel_.switching_functions() > 0)
    here_.state.mode.assign(at(kernel_.switching_functions()), 0);
  if (start.transition.termination != Termination::completed) {
    here_.state.alpha.resize(here_.state.mode.size(), 0.0);
    recorder_.row(here_.t, here_.x, here_.state, here_.state.alpha);
    fail(start.transition.termination, start.transition.message);
    return false;
  }
  choices_.choose(start.transition, progress());
  here_.change_mode(start.transition.state);
  cascade_.transition() = start.transition;
  if (!enter(start.transition) || !settle_at_start()) {
    recorder_.row(here_.t, here_.x, here_.state, here_.state.alpha);
    return false;
  }
  record_start(start);
  static_cast<void>(user_events_.update(here_.t, here_.x.data(), here_.state.alpha, search_.user_signs()));
  start_step();
  here_.time_scale = here_.h;
  const auto& orders = start.transition.zero_order;
  if (event_.rooted < 0 && std::any_of(orders.begin(), orders.end(), [](int order) { return order > 1; })) {
    event_.rooted = zeros_.root_here();
    if (event_.rooted >= 0 && !take_side_of_root()) return false;
  }
  here_.h = steps_.memory().change(here_.state.mode, here_.t, here_.h);
  rows_.skip_here();
  if (recorder_.events() > 0) choices_.watch(field_);
  return true;
}

CompactIntegration Run::to_end(const StepObserver& observer, const TakeRecording& take) {
  if (begin()) {
    while (outcome_.running && here_.t < options_.until) {
      contacts_.forget_impulses(here_.x);
      if (outcome_.result.statistics.steps + outcome_.result.statistics.rejected >= options_.max_steps) {
        fail(Termination::iteration_limit,
             fmt::format("max_steps = {} reached at {}{}", options_.max_steps, where(), advice_on_steps()));
        break;
      }
      if (event_.spiral) begin_spiral();
      if (event_.rooted >= 0) leave_root();
      if (!outcome_.running || here_.t >= options_.until) break;
      const double h = std::max(here_.h, 2.0 * here_.smallest_step());
      steps_.begin(options_.max_step ? std::min(h, *options_.max_step) : h);
      while (outcome_.running && attempt() == Step::shortened) {
      }
      if (outcome_.running && observer &&
          observer({here_.t, outcome_.result.statistics.steps, recorder_.events(), shown_state()}) == Continue::no) {
        fail(Termination::stopped_by_user, fmt::format("stopped at {}", where()));
      }
      if (take && recorder_.has_many()) take(recorder_.hand_over());
    }
  }
  if (!recorder_.ends_at(here_.t)) row(here_.t, here_.x);
  if (const auto stiff_at = steps_.stiff_at()) {
    outcome_.result.status.message +=
        fmt::format("{}the model looks stiff from t = {:.6g} on: integrator = \"radau5\" may need far fewer steps",
                    outcome_.result.status.message.empty() ? "" : "; ", *stiff_at);
  }
  outcome_.result.status.time_reached = here_.t;
  outcome_.result.statistics.thinned_from = rows_.thinned_from();
  outcome_.result.statistics.rhs_evaluations = kernel_.field_evaluations() - outcome_.evaluations_before;
  choices_.families().close(here_.t);
  outcome_.result.recording = recorder_.take();
  outcome_.result.recording.families = choices_.families().take();
  outcome_.result.chosen = choices_.begin_at_choice(outcome_.result.recording, outcome_.result.statistics);
  outcome_.result.pieces = rows_.take_pieces(outcome_.result.recording.row_times);
  return std::move(outcome_.result);
}

}  // namespace saltus::event_integrator
