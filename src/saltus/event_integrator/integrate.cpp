#include "saltus/event_integrator/integrate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "saltus/event_integrator/at_surface.hpp"
#include "saltus/event_integrator/continuations.hpp"
#include "saltus/event_integrator/event_search.hpp"
#include "saltus/event_integrator/locate.hpp"
#include "saltus/event_integrator/mode_field.hpp"
#include "saltus/event_integrator/recorder.hpp"
#include "saltus/event_integrator/start.hpp"
#include "saltus/event_integrator/switch_series.hpp"
#include "saltus/event_integrator/transition.hpp"
#include "saltus/event_integrator/user_events.hpp"
#include "saltus/ode/step_control.hpp"

namespace saltus::event_integrator {
namespace {

using result::Termination;

constexpr double epsilon = std::numeric_limits<double>::epsilon();
std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// The local error of a step is kept to a tenth of the tolerance, so that the error of the whole run is about the
/// tolerance and shallow dips of a switching function are seen at loose tolerances, too (the relay, 401 tolerances from
/// 1e-3 to 1e-12: dopri5 finds all events at each, dop853 at 395; without the factor 388 and 367). Not below what
/// doubles carry.
ode::Tolerances local_tolerances(const ode::Tolerances& wanted) {
  constexpr double share = 0.1;
  return {std::max(share * wanted.rtol, std::min(wanted.rtol, 4.0 * epsilon)), share * wanted.atol};
}

bool is_finite(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [](double value) { return std::isfinite(value); });
}

/// The run in progress: where it is, and the work spaces of its parts. One object per call of integrate().
class Run {
 public:
  Run(const evaluation::ModelKernel& kernel, const model::System& system, const IntegrationOptions& options,
      const StepObserver& observer)
      : kernel_(kernel),
        options_(options),
        observer_(observer),
        surroundings_{kernel, system, is_affine(system)},
        field_(kernel, surroundings_.affine_in_alpha),
        stepper_(options.method, kernel.states()),
        control_(options.method),
        tolerances_(local_tolerances(options.tolerances)),
        search_(kernel, field_, options.method, tolerances_),
        user_events_(kernel, system),
        recorder_(kernel, system),
        t_(options.from),
        x_(system.initial_state),
        slope_(x_.size()),
        row_x_(x_.size()),
        row_slope_(x_.size()),
        series_(options.until - options.from) {}

  Integration to_end();

 private:
  static bool is_affine(const model::System& system) {
    return system.inclusion == model::Inclusion::filippov || system.multi_affine;
  }
  enum class Step { taken, shortened, failed };

  bool begin();
  Step attempt();
  Step undefined_step();
  Step accept(double t_new);
  Step handle(Located located);
  bool change_mode(const Located& located);
  bool enter(const Transition& transition);
  bool fire_user_events(const ModeState& before);
  void flip_user_functions(const Located& located);
  bool too_many_events();
  void accumulates();
  bool stopped_by_two_fold();
  bool shorten(double factor);
  void rows_until(double t_end);
  void row(double t, const std::vector<double>& x);
  void fail(Termination termination, std::string message);
  /// Below this a step is no longer seen in t.
  [[nodiscard]] double smallest_step() const {
    return std::max(4.0 * epsilon * std::abs(t_), std::numeric_limits<double>::min());
  }
  [[nodiscard]] double span() const { return options_.until - options_.from; }
  [[nodiscard]] std::string where() const;

  auto right_hand_side() {
    return [this](double t, const double* x, double* xdot) { field_(t, x, xdot); };
  }

  const evaluation::ModelKernel& kernel_;
  const IntegrationOptions& options_;
  const StepObserver& observer_;
  Surroundings surroundings_;
  ModeField field_;
  ode::Stepper stepper_;
  ode::StepControl control_;
  ode::StiffnessWatch stiffness_;
  ode::Tolerances tolerances_;  ///< of a step
  ode::DenseStep dense_;
  EventSearch search_;
  UserEvents user_events_;
  Recorder recorder_;

  double t_;
  std::vector<double> x_, slope_;
  std::vector<double> row_x_, row_slope_;
  ModeState state_;
  std::optional<double> stiff_at_;  ///< where the explicit method first looked out of place
  double h_ = 0.0;                  ///< proposed step
  double h_try_ = 0.0;              ///< step under trial
  double h_scale_ = 0.0;            ///< of the last full step: time scale of the second-order sign tests
  std::size_t next_output_ = 0;
  double last_event_time_ = -std::numeric_limits<double>::infinity();
  SwitchSeries series_;
  Integration result_;
  bool running_ = true;
};

std::string Run::where() const {
  std::string text;
  for (std::size_t j = 0; j < state_.mode.size(); ++j) {
    if (state_.mode[j] != 0) continue;
    text += (text.empty() ? "" : ", ") + surroundings_.system.switching[j].name;
  }
  return fmt::format("t = {:.17g}{}", t_, text.empty() ? "" : " while sliding on " + text);
}

void Run::fail(Termination termination, std::string message) {
  result_.status.termination = termination;
  result_.status.message = std::move(message);
  running_ = false;
}

void Run::row(double t, const std::vector<double>& x) {
  if (!state_.sliding.empty()) field_(t, x.data(), row_slope_.data());
  recorder_.row(t, x, state_.mode, state_.sliding.empty() ? state_.alpha : field_.alpha());
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
    field_.project(t, row_x_.data());
    row(t, row_x_);
  }
}

bool Run::enter(const Transition& transition) {
  state_ = transition.state;
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
    fail(Termination::evaluation_failed,
         fmt::format("the right-hand side is not finite at {}; change the initial values, or guard the expression with "
                     "if(…)",
                     where()));
    return false;
  }
  search_.enter(state_, transition.zero_order, t_, x_.data());
  return true;
}

bool Run::begin() {
  h_scale_ = 1e-3 * span();
  if (!is_finite(x_)) {
    fail(Termination::evaluation_failed, "the initial state is not finite");
    return false;
  }
  const auto start = decide_start(surroundings_, t_, x_.data(), h_scale_, options_.initial_mode);
  state_ = start.transition.state;
  if (state_.mode.empty() && kernel_.switching_functions() > 0)
    state_.mode.assign(at(kernel_.switching_functions()), 0);
  if (start.transition.termination != Termination::completed) {
    state_.alpha.resize(state_.mode.size(), 0.0);
    recorder_.row(t_, x_, state_.mode, state_.alpha);
    fail(start.transition.termination, start.transition.message);
    return false;
  }
  if (!enter(start.transition)) {
    recorder_.row(t_, x_, state_.mode, state_.alpha);
    return false;
  }
  row(t_, x_);
  auto listed = start.at_zero;
  for (const auto& [surface, mode] : options_.initial_mode) {
    if (std::find(listed.begin(), listed.end(), surface) == listed.end()) listed.push_back(surface);
  }
  auto transition = start.transition;
  transition.state = state_;
  if (!listed.empty() && recorder_.started(t_, x_, transition, listed)) row(t_, x_);
  static_cast<void>(user_events_.update(t_, x_.data(), state_.alpha, search_.user_signs()));
  h_ = ode::initial_step(options_.method, right_hand_side(), t_, x_.data(), slope_.data(), kernel_.states(), span(),
                         tolerances_);
  field_(t_, x_.data(), row_slope_.data());  // selections back to the start point's
  h_scale_ = h_;
  while (next_output_ < options_.output.times.size() && options_.output.times[next_output_] <= t_) ++next_output_;
  return true;
}

bool Run::shorten(double factor) {
  ++result_.statistics.rejected;
  h_try_ *= factor;
  h_ = h_try_;
  if (h_try_ > smallest_step()) return true;
  return false;
}

/// Whether the steps got short because the sliding selection has no limit here.
bool Run::stopped_by_two_fold() {
  const auto message = two_fold_message(surroundings_, state_, t_, x_.data());
  if (message) fail(Termination::outside_class, *message);
  return message.has_value();
}

/// The right-hand side is undefined however short the step: the region of this field ends here, or the model does.
Run::Step Run::undefined_step() {
  std::vector<double> values(search_.functions().size());
  search_.evaluate(t_, x_.data(), values);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto& function = search_.functions()[i];
    const bool surface = function.kind == FunctionKind::surface;
    if (!surface && function.kind != FunctionKind::loss) continue;
    // The zero lies within the time that can no longer be resolved, or the selection has become double.
    const double rate = surface ? kernel_.lie_derivative(function.index, 1, t_, x_.data(), state_.alpha.data()) : 0.0;
    const bool reached = surface ? values[i] * rate < 0.0 && std::abs(values[i] / rate) <= 1e3 * smallest_step()
                                 : std::abs(values[i]) < 1e-3;
    if (reached) {
      Located located{t_, x_, {i}, {function.sign}};
      if (surface) move_onto(kernel_, state_, function.index, t_, located.x);
      return handle(std::move(located));
    }
  }
  if (stopped_by_two_fold()) return Step::failed;
  fail(Termination::evaluation_failed,
       fmt::format("the right-hand side is not finite beyond {}, however short the step; guard the expression with "
                   "if(…), or end the simulation before",
                   where()));
  return Step::failed;
}

Run::Step Run::accept(double t_new) {
  ++result_.statistics.steps;
  rows_until(t_new);
  const double h = t_new - t_;
  std::copy(stepper_.x_new(), stepper_.x_new() + x_.size(), x_.begin());
  t_ = t_new;
  h_scale_ = h;
  if (field_.project(t_, x_.data())) {
    field_(t_, x_.data(), slope_.data());
  } else {
    std::copy(stepper_.slope_new(), stepper_.slope_new() + slope_.size(), slope_.begin());
  }
  h_ = h * control_.accepted(stepper_.error_norm());
  if (!stiff_at_ && stiffness_.looks_stiff(stepper_)) stiff_at_ = t_;
  if (search_.settle(t_, x_.data())) {
    // What a user function turns to from a zero at the start is its first sign, not a change of it.
    static_cast<void>(user_events_.update(t_, x_.data(), state_.alpha, search_.user_signs()));
  }
  const bool requested = next_output_ < options_.output.times.size() && options_.output.times[next_output_] == t_;
  if (requested) ++next_output_;
  if (options_.output.rows == OutputTimes::Rows::at_steps || requested || t_ >= options_.until) row(t_, x_);
  return Step::taken;
}

Run::Step Run::attempt() {
  const bool to_the_end = t_ + h_try_ * (1.0 + 4.0 * epsilon) >= options_.until;
  const double t_new = to_the_end ? options_.until : t_ + h_try_;
  const double h = t_new - t_;
  if (stepper_.attempt(right_hand_side(), t_, x_.data(), slope_.data(), h, tolerances_) == ode::Attempt::undefined) {
    return shorten(0.25) ? Step::shortened : undefined_step();
  }
  if (const double error = stepper_.error_norm(); !(error <= 1.0)) {
    if (shorten(control_.rejected(error))) return Step::shortened;
    if (stopped_by_two_fold()) return Step::failed;
    fail(Termination::step_size_too_small,
         fmt::format("the tolerance cannot be reached at {}: the step has fallen to {:.3g}; the solution may blow up "
                     "there, or rtol is below what doubles carry",
                     where(), h));
    return Step::failed;
  }
  const bool rows_inside = next_output_ < options_.output.times.size() && options_.output.times[next_output_] < t_new;
  if (!search_.functions().empty() || rows_inside) {
    if (stepper_.dense(right_hand_side(), dense_) == ode::Attempt::undefined) {
      return shorten(0.5) ? Step::shortened : undefined_step();
    }
    Hit hit;
    switch (search_.search(dense_, hit)) {
      case SearchOutcome::none:
        break;
      case SearchOutcome::unresolved:
        return shorten(0.5) ? Step::shortened : undefined_step();
      case SearchOutcome::hit: {
        const StepStart start{t_, x_.data(), slope_.data()};
        h_scale_ = h;
        auto located = locate(stepper_, field_, search_, tolerances_, start, dense_, hit);
        if (!located) return shorten(0.5) ? Step::shortened : undefined_step();
        ++result_.statistics.steps;
        rows_until(located->t);
        return handle(std::move(*located));
      }
    }
  }
  return accept(t_new);
}

bool Run::fire_user_events(const ModeState& before) {
  const auto fired = user_events_.update(t_, x_.data(), state_.alpha, search_.user_signs());
  for (const int event : fired) {
    recorder_.user(t_, x_, before, state_, event);
    if (user_events_.stops(event) && running_) {
      fail(Termination::stopped_by_event,
           fmt::format("stopped by the event '{}'", surroundings_.system.events[at(event)].name));
    }
  }
  return !fired.empty();
}

bool Run::too_many_events() {
  if (recorder_.events() >= options_.max_events) {
    fail(Termination::iteration_limit, fmt::format("max_events = {} reached at {}", options_.max_events, where()));
    return true;
  }
  if (!series_.too_dense(t_)) return false;
  accumulates();
  return true;
}

void Run::accumulates() {
  if (stopped_by_two_fold()) return;
  fail(Termination::outside_class,
       fmt::format(
           "switches accumulate at t = {:.17g} (spiral into an intersection of surfaces, or chattering): passing "
           "the limit needs the codimension-2 switching of a later version",
           t_));
}

bool Run::change_mode(const Located& located) {
  Occasion occasion;
  occasion.t = t_;
  occasion.x = x_.data();
  occasion.time_scale = h_scale_;
  occasion.at_zero = state_.sliding;
  bool any = false;
  for (std::size_t k = 0; k < located.functions.size(); ++k) {
    const auto& function = search_.functions()[located.functions[k]];
    if (function.kind == FunctionKind::user) continue;
    any = true;
    if (function.kind == FunctionKind::exit_below) occasion.exit_below.push_back(function.index);
    if (function.kind == FunctionKind::exit_above) occasion.exit_above.push_back(function.index);
    const bool nested = function.kind == FunctionKind::nested_below || function.kind == FunctionKind::nested_above;
    if (nested && !continuous_across(kernel_, state_, function.index, t_, x_)) {
      fail(Termination::outside_class,
           fmt::format(
               "'{}' jumps across the surface of '{}', on which the solution slides, and reaches 0 on one side of "
               "it at t = {:.17g}: rewrite the nested term with named switching functions",
               surroundings_.system.switching[at(function.index)].name,
               surroundings_.system.switching[at(state_.sliding.front())].name, t_));
      return false;
    }
    occasion.at_zero.push_back(function.index);
    occasion.touched.push_back(function.index);
  }
  if (!any) return true;
  std::sort(occasion.at_zero.begin(), occasion.at_zero.end());
  occasion.at_zero.erase(std::unique(occasion.at_zero.begin(), occasion.at_zero.end()), occasion.at_zero.end());
  const ModeState before = state_;
  auto transition = decide_mode(surroundings_, before, occasion);
  if (transition.termination != Termination::completed) {
    fail(transition.termination, std::move(transition.message));
    return false;
  }
  if (series_.repeats(t_, before.mode, transition.state.mode)) {
    accumulates();
    return false;
  }
  other_continuations(surroundings_, before, occasion, transition);
  if (!enter(transition)) return false;
  transition.state = state_;
  recorder_.switched(t_, x_, before, transition);
  control_.reset();
  return true;
}

/// User functions that vanish here continue with the other sign.
void Run::flip_user_functions(const Located& located) {
  const auto each = [&](auto&& set) {
    for (std::size_t k = 0; k < located.functions.size(); ++k) {
      if (search_.functions()[located.functions[k]].kind == FunctionKind::user)
        set(located.functions[k], located.signs[k]);
    }
  };
  // The signs before become known now, if they were not; only then do all of them change.
  each([&](std::size_t function, int sign) { search_.set_user_sign(function, sign, t_, x_.data()); });
  static_cast<void>(user_events_.update(t_, x_.data(), state_.alpha, search_.user_signs()));
  each([&](std::size_t function, int sign) { search_.set_user_sign(function, -sign, t_, x_.data()); });
}

/// The state is at a located event: rows before and behind, user events, the next mode.
Run::Step Run::handle(Located located) {
  const bool ended_here = located.t == t_ && recorder_.ends_at(t_) && t_ != last_event_time_;
  t_ = located.t;
  x_ = std::move(located.x);
  const long events_before = recorder_.events();
  const ModeState before = state_;
  field_(t_, x_.data(), slope_.data());
  if (!state_.sliding.empty()) state_.alpha = field_.alpha();
  const std::vector<double> x_before = x_;
  const auto alpha_before = state_.sliding.empty() ? state_.alpha : field_.alpha();
  flip_user_functions(located);
  static_cast<void>(change_mode(located));
  if (running_) fire_user_events(before);
  if (recorder_.events() > events_before || !running_) {
    // A step that ended exactly here has written the row before the event.
    if (!ended_here) recorder_.row(t_, x_before, before.mode, alpha_before);
    if (recorder_.events() > events_before) row(t_, x_);
  } else if (options_.output.rows == OutputTimes::Rows::at_steps) {
    row(t_, x_);
  }
  while (next_output_ < options_.output.times.size() && options_.output.times[next_output_] <= t_) {
    // A requested time at a restart that is no event still gets its row.
    const bool wanted = options_.output.times[next_output_] == t_ && recorder_.events() == events_before &&
                        options_.output.rows == OutputTimes::Rows::at_times && running_;
    if (wanted) row(t_, x_);
    ++next_output_;
  }
  if (recorder_.events() > events_before) last_event_time_ = t_;
  if (running_) static_cast<void>(too_many_events());
  return running_ ? Step::taken : Step::failed;
}

Integration Run::to_end() {
  if (begin()) {
    while (running_ && t_ < options_.until) {
      if (result_.statistics.steps + result_.statistics.rejected >= options_.max_steps) {
        fail(Termination::iteration_limit, fmt::format("max_steps = {} reached at {}", options_.max_steps, where()));
        break;
      }
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
  result_.statistics.rhs_evaluations = kernel_.field_evaluations();
  result_.events = recorder_.take_events();
  result_.trajectory = recorder_.take_trajectory();
  const auto& rows = result_.trajectory;
  result_.final = {t_, rows.x.back(), rows.mode.back(), rows.alpha.back(), rows.outputs.back()};
  return std::move(result_);
}

}  // namespace

Integration integrate(const evaluation::ModelKernel& kernel, const model::System& system,
                      const IntegrationOptions& options, const StepObserver& observer) {
  return Run(kernel, system, options, observer).to_end();
}

}  // namespace saltus::event_integrator
