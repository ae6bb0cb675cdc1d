#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "saltus/event_integrator/decide/start.hpp"
#include "saltus/event_integrator/mode/regions.hpp"
#include "saltus/event_integrator/mode/undefined.hpp"
#include "saltus/event_integrator/run/run_internal.hpp"
#include "saltus/event_integrator/run/thin_layers.hpp"
#include "saltus/model/vanishing_norm.hpp"

namespace saltus::event_integrator {
namespace {

using result::Termination;

bool is_affine(const model::System& system) {
  return system.inclusion == model::Inclusion::filippov || system.multi_affine;
}

}  // namespace

Run::Run(evaluation::ModelKernel& kernel, const model::System& system, const IntegrationOptions& options,
         const StepObserver& observer, Way way)
    : kernel_(kernel),
      options_(options),
      observer_(observer),
      surroundings_{kernel, system, is_affine(system), options.selection, options.scaling},
      field_(kernel, surroundings_.affine_in_alpha),
      here_(options.from, system.initial_state),
      rates_(kernel, here_),
      tolerances_(options.tolerances),
      steps_(options, system, field_, here_, tolerances_),
      cells_(kernel),
      search_(kernel, field_, options.method, tolerances_.step()),
      locator_(options.method, kernel.states(), steps_.stepper(), field_, search_, tolerances_.step()),
      single_surface_(surroundings_),
      surface_pair_(surroundings_),
      field_memory_(kernel),
      slope_beyond_(at(kernel.states())),
      user_events_(kernel, system),
      jumps_(kernel, system, options.from),
      contacts_(kernel, system),
      holding_(kernel, system),
      shortest_switch_lap_(3 * system.switching.size(), 0.0),
      last_guard_(system.jumps.size(), {{-1, -1}, -1}),
      last_rate_(system.jumps.size(), 0.0),
      shortest_lap_(system.jumps.size(), 0.0),
      recorder_(kernel, system),
      rows_(kernel, options, here_, field_, holding_, recorder_),
      free_slope_(here_.x.size()),
      families_(surroundings_),
      evaluations_before_(kernel.field_evaluations()),
      series_(options.until - options.from) {
  holding_.keep(&contacts_);
  for (int j = 0; j < kernel.switching_functions(); ++j) {
    if (kernel.root_is_continued(j)) {
      continued_roots_.push_back(j);
    } else if (kernel.has_root(j)) {
      ending_roots_.push_back(j);
    }
  }
  ordinary_ = way == Way::short_where_ordinary && has_ordinary_switches();
}

std::string Run::where() const {
  std::string text;
  for (const int j : here_.state.sliding) {
    text += (text.empty() ? "" : ", ") + surroundings_.system.switching[at(j)].name;
  }
  return fmt::format("t = {:.17g}{}", here_.t, text.empty() ? "" : " while sliding on " + text);
}

void Run::fail(Termination termination, std::string message) {
  result_.status.termination = termination;
  result_.status.message = std::move(message);
  running_ = false;
}

bool Run::enter(const Transition& transition) {
  here_.state = transition.state;
  no_surface_at_.reset();
  set_references(kernel_, here_.state);
  tolerances_.begin_mode(kernel_, options_.layers, here_);
  watch_nested_roots();
  field_.enter(here_.state);
  steps_.begin_mode();
  field_.project(here_.t, here_.x.data());
  field_(here_.t, here_.x.data(), here_.slope.data());
  if (!is_finite(here_.slope) && !transition.beside.empty()) {
    // The field is undefined on the far side of its own surface, where rounding has put the state.
    here_.x = transition.beside;
    field_(here_.t, here_.x.data(), here_.slope.data());
  }
  if (!is_finite(here_.slope)) {
    fail(
        Termination::evaluation_failed,
        fmt::format("the right-hand side of {} is not finite at {}; change the initial values, or guard the expression "
                    "with if(…)",
                    undefined_states(surroundings_.system, here_.slope), where()));
    return false;
  }
  search_.enter(here_.state, transition.zero_order, here_.t, here_.x.data());
  spiral_start_ = transition.beyond_spiral;
  rooted_ = transition.rooted;
  return true;
}

/// Over the first lap of a spiral that leaves an intersection, which is too small to be seen.
void Run::begin_spiral() {
  const SpiralStart start = *std::exchange(spiral_start_, std::nullopt);
  const double t_new = std::min(here_.t + start.duration, options_.until);
  rows_.each_until(here_.t, t_new, [&](double t) { rows_.write(t, start.x); });
  here_.t = t_new;
  here_.x = start.x;
  Transition beyond;
  beyond.state = here_.state;
  beyond.zero_order.assign(here_.state.mode.size(), 0);
  beyond.zero_order[at(start.surface)] = 1;
  if (!enter(beyond)) return;
  if (rows_.at_steps()) row(here_.t, here_.x);
}

bool Run::begin() {
  here_.time_scale = 1e-3 * span();
  if (!is_finite(here_.x)) {
    fail(Termination::evaluation_failed,
         fmt::format("the initial value of {} is not finite", undefined_states(surroundings_.system, here_.x)));
    return false;
  }
  if (!cells_.empty())
    cells_.locate(here_.t, here_.x.data(), std::vector<double>(at(kernel_.switching_functions()), 0.5));
  Landing& landing = landing_here();
  if (!begin_jumps(landing)) {
    recorder_.row(here_.t, here_.x, here_.state, here_.state.alpha);
    return false;
  }
  const auto decided = [&] {
    return decide_start(surroundings_, here_.t, here_.x.data(), here_.time_scale, options_.initial_mode);
  };
  auto start = decided();
  // At a break the field says into which cell the solution moves, and the cells say what the field is.
  for (int pass = 0; pass < 4 && !cells_.empty(); ++pass) {
    if (start.transition.termination != Termination::completed) break;
    if (cells_.locate(here_.t, here_.x.data(), start.transition.state.alpha) == CellChange::none) break;
    start = decided();
  }
  here_.state = start.transition.state;
  if (here_.state.mode.empty() && kernel_.switching_functions() > 0)
    here_.state.mode.assign(at(kernel_.switching_functions()), 0);
  if (start.transition.termination != Termination::completed) {
    here_.state.alpha.resize(here_.state.mode.size(), 0.0);
    recorder_.row(here_.t, here_.x, here_.state, here_.state.alpha);
    fail(start.transition.termination, start.transition.message);
    return false;
  }
  choose(start.transition);
  here_.state = start.transition.state;
  landing.transition = start.transition;
  if (!enter(start.transition) || !settle_at_start(landing)) {
    recorder_.row(here_.t, here_.x, here_.state, here_.state.alpha);
    return false;
  }
  row(here_.t, here_.x);
  auto listed = start.at_zero;
  for (const auto& [surface, mode] : options_.initial_mode) {
    if (std::find(listed.begin(), listed.end(), surface) == listed.end()) listed.push_back(surface);
  }
  auto transition = start.transition;
  transition.state = here_.state;
  if (!landing.executed.empty()) {
    recorder_.jumped(here_.t, landing.executed.items(), nullptr, landing.transition);
    if (!landing.resting.empty()) {
      recorder_.accumulated(here_.t, landing.resting, {here_.x, here_.x, here_.state, here_.state}, resting_reason);
    }
    last_event_time_ = here_.t;
  } else if (!listed.empty() && recorder_.started(here_.t, here_.x, transition, listed))
    row(here_.t, here_.x);
  static_cast<void>(user_events_.update(here_.t, here_.x.data(), here_.state.alpha, search_.user_signs()));
  start_step();
  here_.time_scale = here_.h;
  const auto& orders = start.transition.zero_order;
  if (rooted_ < 0 && std::any_of(orders.begin(), orders.end(), [](int order) { return order > 1; })) {
    rooted_ = root_here();
    if (rooted_ >= 0 && !take_side_of_root()) return false;
  }
  here_.h = steps_.memory().change(here_.state.mode, here_.t, here_.h);
  rows_.skip_here();
  if (recorder_.events() > 0) watch_for_families();
  return true;
}

CompactIntegration Run::to_end() {
  if (begin()) {
    while (running_ && here_.t < options_.until) {
      contacts_.forget_impulses(here_.x);
      if (result_.statistics.steps + result_.statistics.rejected >= options_.max_steps) {
        fail(Termination::iteration_limit, fmt::format("max_steps = {} reached at {}{}", options_.max_steps, where(),
                                                       model::vanishing_norm(surroundings_.system, here_.t, here_.x)));
        break;
      }
      if (spiral_start_) begin_spiral();
      if (rooted_ >= 0) leave_root();
      if (!running_ || here_.t >= options_.until) break;
      undefined_ahead_ = false;
      const double h = std::max(here_.h, 2.0 * here_.smallest_step());
      steps_.set_length(options_.max_step ? std::min(h, *options_.max_step) : h);
      while (running_ && attempt() == Step::shortened) {
      }
      if (running_ && observer_ && observer_({here_.t, result_.statistics.steps, recorder_.events()}) == Continue::no) {
        fail(Termination::stopped_by_user, fmt::format("stopped at {}", where()));
      }
    }
  }
  if (!recorder_.ends_at(here_.t)) row(here_.t, here_.x);
  if (const auto stiff_at = steps_.stiff_at()) {
    result_.status.message +=
        fmt::format("{}the model looks stiff from t = {:.6g} on: integrator = \"radau5\" may need far fewer steps",
                    result_.status.message.empty() ? "" : "; ", *stiff_at);
  }
  result_.status.time_reached = here_.t;
  result_.statistics.rhs_evaluations = kernel_.field_evaluations() - evaluations_before_;
  families_.close(here_.t);
  result_.recording = recorder_.take();
  result_.recording.families = families_.take();
  begin_at_choice();
  return std::move(result_);
}

}  // namespace saltus::event_integrator
