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

/// The local error of a step is kept to a tenth of the tolerance, so that the error of the whole run is about the
/// tolerance and shallow dips of a switching function are seen at loose tolerances, too (the relay, 401 tolerances from
/// 1e-3 to 1e-12: dopri5 finds all events at each, dop853 at 395; without the factor 388 and 367). Not below what
/// doubles carry.
ode::Tolerances local_tolerances(const ode::Tolerances& wanted) {
  constexpr double share = 0.1;
  return {std::max(share * wanted.rtol, std::min(wanted.rtol, 4.0 * rounding_unit)), share * wanted.atol};
}

bool is_affine(const model::System& system) {
  return system.inclusion == model::Inclusion::filippov || system.multi_affine;
}

}  // namespace

Run::Run(const evaluation::ModelKernel& kernel, const model::System& system, const IntegrationOptions& options,
         const StepObserver& observer, Way way)
    : kernel_(kernel),
      options_(options),
      observer_(observer),
      surroundings_{kernel, system, is_affine(system), options.selection, options.scaling},
      field_(kernel, surroundings_.affine_in_alpha),
      stepper_(options.method, kernel.states()),
      control_(options.method),
      tolerances_(local_tolerances(options.tolerances)),
      cells_(kernel),
      search_(kernel, field_, options.method, tolerances_),
      locator_(options.method, kernel.states(), stepper_, field_, search_, tolerances_),
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
      t_(options.from),
      x_(system.initial_state),
      slope_(x_.size()),
      row_x_(x_.size()),
      row_slope_(x_.size()),
      dense_slope_(x_.size()),
      families_(surroundings_),
      evaluations_before_(kernel.field_evaluations()),
      series_(options.until - options.from) {
  mode_tolerances_ = tolerances_;
  holding_.keep(&contacts_);
  for (int j = 0; j < kernel.switching_functions(); ++j) {
    if (kernel.root_is_continued(j)) {
      continued_roots_.push_back(j);
    } else if (kernel.has_root(j)) {
      ending_roots_.push_back(j);
    }
  }
  if (options.output.straight > 0.0) {
    line_rows_.emplace(
        LineRows{ode::ColumnRanges(x_.size() + at(kernel.controls() + kernel.outputs() + kernel.switching_functions()),
                                   options.output.straight, tolerances_),
                 {},
                 {},
                 {},
                 {}});
    recorder_.widen(line_rows_->ranges, options.output.selections);
  }
  ordinary_ = way == Way::short_where_ordinary && has_ordinary_switches();
  for (std::size_t i = 0; i < x_.size(); ++i) {
    if (i >= system.discrete_states.size() || !system.discrete_states[i]) continuous_.push_back(i);
  }
  if (!continuous_.empty()) {
    error_share_ = std::sqrt(static_cast<double>(x_.size()) / static_cast<double>(continuous_.size()));
  }
}

std::string Run::where() const {
  std::string text;
  for (const int j : state_.sliding) {
    text += (text.empty() ? "" : ", ") + surroundings_.system.switching[at(j)].name;
  }
  return fmt::format("t = {:.17g}{}", t_, text.empty() ? "" : " while sliding on " + text);
}

void Run::fail(Termination termination, std::string message) {
  result_.status.termination = termination;
  result_.status.message = std::move(message);
  running_ = false;
}

bool Run::enter(const Transition& transition) {
  state_ = transition.state;
  no_surface_at_.reset();
  set_references(kernel_, state_);
  if (!options_.layers.empty()) {
    const auto wanted = local_tolerances(options_.tolerances);
    mode_tolerances_ = within_layers(kernel_, options_.layers, wanted, state_, t_, x_.data());
  }
  root_share_ = 1.0;
  watch_nested_roots();
  set_tolerances();
  field_.enter(state_);
  stepper_.restart();
  stiffness_.reset();
  field_.project(t_, x_.data());
  field_(t_, x_.data(), slope_.data());
  if (!is_finite(slope_) && !transition.beside.empty()) {
    // The field is undefined on the far side of its own surface, where rounding has put the state.
    x_ = transition.beside;
    field_(t_, x_.data(), slope_.data());
  }
  if (!is_finite(slope_)) {
    fail(
        Termination::evaluation_failed,
        fmt::format("the right-hand side of {} is not finite at {}; change the initial values, or guard the expression "
                    "with if(…)",
                    undefined_states(surroundings_.system, slope_), where()));
    return false;
  }
  search_.enter(state_, transition.zero_order, t_, x_.data());
  spiral_start_ = transition.beyond_spiral;
  rooted_ = transition.rooted;
  return true;
}

/// Over the first lap of a spiral that leaves an intersection, which is too small to be seen.
void Run::begin_spiral() {
  const SpiralStart start = *std::exchange(spiral_start_, std::nullopt);
  const double t_new = std::min(t_ + start.duration, options_.until);
  const auto& times = options_.output.times;
  for (; next_output_ < times.size() && times[next_output_] <= t_new; ++next_output_) {
    if (times[next_output_] > t_) row(times[next_output_], start.x);
  }
  t_ = t_new;
  x_ = start.x;
  Transition beyond;
  beyond.state = state_;
  beyond.zero_order.assign(state_.mode.size(), 0);
  beyond.zero_order[at(start.surface)] = 1;
  if (!enter(beyond)) return;
  if (options_.output.rows == OutputTimes::Rows::at_steps) row(t_, x_);
}

bool Run::begin() {
  h_scale_ = 1e-3 * span();
  if (!is_finite(x_)) {
    fail(Termination::evaluation_failed,
         fmt::format("the initial value of {} is not finite", undefined_states(surroundings_.system, x_)));
    return false;
  }
  if (!cells_.empty()) cells_.locate(t_, x_.data(), std::vector<double>(at(kernel_.switching_functions()), 0.5));
  Landing& landing = landing_here();
  if (!begin_jumps(landing)) {
    recorder_.row(t_, x_, state_, state_.alpha);
    return false;
  }
  const auto decided = [&] { return decide_start(surroundings_, t_, x_.data(), h_scale_, options_.initial_mode); };
  auto start = decided();
  // At a break the field says into which cell the solution moves, and the cells say what the field is.
  for (int pass = 0; pass < 4 && !cells_.empty(); ++pass) {
    if (start.transition.termination != Termination::completed) break;
    if (cells_.locate(t_, x_.data(), start.transition.state.alpha) == CellChange::none) break;
    start = decided();
  }
  state_ = start.transition.state;
  if (state_.mode.empty() && kernel_.switching_functions() > 0)
    state_.mode.assign(at(kernel_.switching_functions()), 0);
  if (start.transition.termination != Termination::completed) {
    state_.alpha.resize(state_.mode.size(), 0.0);
    recorder_.row(t_, x_, state_, state_.alpha);
    fail(start.transition.termination, start.transition.message);
    return false;
  }
  choose(start.transition);
  state_ = start.transition.state;
  landing.transition = start.transition;
  if (!enter(start.transition) || !settle_at_start(landing)) {
    recorder_.row(t_, x_, state_, state_.alpha);
    return false;
  }
  row(t_, x_);
  auto listed = start.at_zero;
  for (const auto& [surface, mode] : options_.initial_mode) {
    if (std::find(listed.begin(), listed.end(), surface) == listed.end()) listed.push_back(surface);
  }
  auto transition = start.transition;
  transition.state = state_;
  if (!landing.executed.empty()) {
    recorder_.jumped(t_, landing.executed.items(), nullptr, landing.transition);
    if (!landing.resting.empty()) {
      recorder_.accumulated(t_, landing.resting, {x_, x_, state_, state_}, resting_reason);
    }
    last_event_time_ = t_;
  } else if (!listed.empty() && recorder_.started(t_, x_, transition, listed))
    row(t_, x_);
  static_cast<void>(user_events_.update(t_, x_.data(), state_.alpha, search_.user_signs()));
  start_step();
  h_scale_ = h_;
  const auto& orders = start.transition.zero_order;
  if (rooted_ < 0 && std::any_of(orders.begin(), orders.end(), [](int order) { return order > 1; })) {
    rooted_ = root_here();
    if (rooted_ >= 0 && !take_side_of_root()) return false;
  }
  h_ = step_memory_.change(state_.mode, t_, h_);
  while (next_output_ < options_.output.times.size() && options_.output.times[next_output_] <= t_) ++next_output_;
  if (recorder_.events() > 0) watch_for_families();
  return true;
}

CompactIntegration Run::to_end() {
  if (begin()) {
    while (running_ && t_ < options_.until) {
      contacts_.forget_impulses(x_);
      if (result_.statistics.steps + result_.statistics.rejected >= options_.max_steps) {
        fail(Termination::iteration_limit, fmt::format("max_steps = {} reached at {}{}", options_.max_steps, where(),
                                                       model::vanishing_norm(surroundings_.system, t_, x_)));
        break;
      }
      if (spiral_start_) begin_spiral();
      if (rooted_ >= 0) leave_root();
      if (!running_ || t_ >= options_.until) break;
      undefined_ahead_ = false;
      h_try_ = std::max(h_, 2.0 * smallest_step());
      if (options_.max_step) h_try_ = std::min(h_try_, *options_.max_step);
      while (running_ && attempt() == Step::shortened) {
      }
      if (running_ && observer_ && observer_({t_, result_.statistics.steps, recorder_.events()}) == Continue::no) {
        fail(Termination::stopped_by_user, fmt::format("stopped at {}", where()));
      }
    }
  }
  if (!recorder_.ends_at(t_)) row(t_, x_);
  if (stiff_at_) {
    result_.status.message +=
        fmt::format("{}the model looks stiff from t = {:.6g} on: integrator = \"radau5\" may need far fewer steps",
                    result_.status.message.empty() ? "" : "; ", *stiff_at_);
  }
  result_.status.time_reached = t_;
  result_.statistics.rhs_evaluations = kernel_.field_evaluations() - evaluations_before_;
  families_.close(t_);
  result_.recording = recorder_.take();
  result_.recording.families = families_.take();
  begin_at_choice();
  return std::move(result_);
}

}  // namespace saltus::event_integrator
