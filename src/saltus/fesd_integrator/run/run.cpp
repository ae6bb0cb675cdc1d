#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "saltus/base/at.hpp"
#include "saltus/fesd_integrator/run/run_internal.hpp"

namespace saltus::fesd_integrator {
namespace {

/// Estimates are those inside elements, which are larger than those at their ends, and errors grow or decay behind
/// them: of the models of the catalogue with 100 steps all with errors above 1 % at the end are above this.
constexpr double coarse = 0.03;

}  // namespace

Run::Run(const discretization::StageKernel& kernel, const discretization::PointFunctions& functions, const Facts& facts,
         const IntegrationOptions& options, const StepObserver& observer, SensitivityPropagation* propagation)
    : kernel_(kernel),
      functions_(functions),
      facts_(facts),
      options_(options),
      observer_(observer),
      propagation_(propagation),
      solver_(kernel, options.tableau),
      watch_(kernel, solver_),
      transition_(kernel, facts.parts, solver_),
      projected_(kernel),
      fixed_(kernel, facts.parts, solver_),
      held_(functions, facts.held),
      recorder_(functions, facts),
      element_recorder_(options.record_elements ? std::optional<ElementRecorder>({kernel, facts, options.tableau})
                                                : std::nullopt),
      user_events_(functions, facts.events, options.until - options.from),
      t_(options.from),
      x_(facts.initial_state),
      selections_(kernel.selections()),
      nominal_((options.until - options.from) / static_cast<double>(options.steps)),
      longest_part_(nominal_),
      coarseness_(options.error_limit, options.until - options.from) {
  chain_.elements.resize(static_cast<std::size_t>(options.elements));
  chain_.left.resize(static_cast<std::size_t>(options.elements) + 1);
  chain_.errors.resize(static_cast<std::size_t>(options.elements));
  chain_.determined.resize(static_cast<std::size_t>(options.elements));
  between_x_.resize(facts.n_x);
  kernel.size(at_switch_);
  kernel.size(at_roots_);
}

void Run::stop(result::Termination termination, std::string message) {
  if (!status_) status_ = result::Status{termination, std::move(message), t_};
}

Integration Run::run() {
  start();
  const auto steps = static_cast<double>(options_.steps);
  for (long k = 0; k < options_.steps && !stopped(); ++k) {
    // From the ends, not by adding up: no drift in time.
    const double end = k + 1 == options_.steps
                           ? options_.until
                           : options_.from + (options_.until - options_.from) * (static_cast<double>(k + 1) / steps);
    while (!stopped() && t_ < end) {
      const double change = held_.next_change(t_, end, x_.data());
      time_event_.reset();
      // At the end of the run nothing follows that could feel it.
      if (const auto changing = held_.next_changing(); changing && change < options_.until) {
        time_event_ = {change, *changing};
      }
      if (options_.step_problem != nullptr) {
        advance_by_problem(*options_.step_problem, change);
      } else if (options_.switches == IntegrationOptions::Switches::detected) {
        advance(change);
      } else {
        advance_fixed(change);
      }
      if (!stopped() && !facts_.held.empty()) hold_behind();
    }
    show_progress();
  }
  Integration integration;
  if (recorder_.trajectory().t.empty() || !recorder_.ends_at(t_)) {
    recorder_.row(t_, x_, set_, selections_, held_.data());
  }
  integration.status = status_.value_or(result::Status{result::Termination::completed, "", t_});
  integration.status.time_reached = t_;
  if (!status_ && undetermined_) integration.status.message = *undetermined_;
  if (const auto worst = coarseness_.worst()) {
    statistics_.error_estimate = worst->sum;
    if (!status_ && !undetermined_ && worst->sum > options_.error_limit.value_or(coarse)) {
      integration.status.message = coarse_message(*worst);
    }
  }
  integration.final = recorder_.last();
  integration.events = std::move(recorder_.event_list());
  integration.trajectory = std::move(recorder_.trajectory());
  if (element_recorder_) integration.elements = element_recorder_->take();
  statistics_.rhs_evaluations = kernel_.evaluations();
  integration.statistics = statistics_;
  return integration;
}

void Run::start() {
  held_.set_behind(t_, nominal_, x_.data());
  for (const double component : x_) size_ = std::max(size_, std::abs(component));
  std::vector<int> below(kernel_.selections(), -1);
  for (const Part& part : facts_.parts) {
    if (part.simplex) below[at(part.first)] = 0;
  }
  set_ = ActiveSet(facts_.parts, below);
  set_.selections(selections_.data(), selections_.data());
  auto found =
      transition_.continuations({t_, x_, held_.data(), nullptr, {}, size_, nominal_ / options_.elements / 128.0});
  const auto chosen = std::find_if(found.begin(), found.end(), [&](const Continuation& candidate) {
    const auto view = recorder_.view(candidate.set, candidate.selections, held_.data());
    return std::all_of(options_.initial_mode.begin(), options_.initial_mode.end(),
                       [&](const auto& forced) { return view.mode[at(forced.first)] == forced.second; });
  });
  if (chosen == found.end()) {
    if (stopped_where_not_finite()) return;
    stop(result::Termination::no_admissible_mode,
         options_.initial_mode.empty()
             ? fmt::format("no mode continues the solution from the start at t = {:.10g}", t_)
             : fmt::format("no mode with the forced initial_mode continues the solution from t = {:.10g}", t_));
    return;
  }
  const ActiveSet at_zero(facts_.parts, transition_.modes_at_zero());
  const auto zero = recorder_.view(at_zero, selections_, held_.data());
  std::vector<int> functions;
  for (std::size_t j = 0; j < zero.mode.size(); ++j) {
    if (zero.mode[j] == 0) functions.push_back(static_cast<int>(j));
  }
  for (const auto& group : facts_.regions) {
    // A region that is active alone is not on a surface.
    const auto in_group = [&](int j) {
      return j >= group.first && j < group.first + static_cast<int>(group.names.size());
    };
    if (std::count_if(functions.begin(), functions.end(), in_group) == 1) std::erase_if(functions, in_group);
  }
  std::rotate(found.begin(), chosen, chosen + 1);
  continue_with(found);
  if (!user_events_.empty()) {
    static_cast<void>(user_events_.update(t_, x_.data(), selections_.data(), held_.data(), std::nullopt));
  }
  recorder_.started(t_, x_, found, held_.data(), functions);
  if (warp_behind(nominal_) > 1) laps_.add({t_, set_.modes(), x_, 0.0});
  row_here();
}

bool Run::stopped_where_not_finite() {
  if (transition_.finite()) {
    auto steep = steep_here();
    if (steep) stop(result::Termination::evaluation_failed, std::move(*steep));
    return steep.has_value();
  }
  stop(result::Termination::evaluation_failed,
       fmt::format("indicators of regions are not finite at t = {:.10g}; change the state there or their expressions, "
                   "or take reformulation = \"step\" or method = \"event\"",
                   t_));
  return true;
}

void Run::continue_with(const std::vector<Continuation>& found) {
  set_ = found.front().set;
  selections_ = found.front().selections;
  determined_ = found.front().determined;
  const bool all = std::all_of(found.begin(), found.end(), [](const auto& other) { return other.determined; });
  if (!all && !undetermined_) undetermined_ = undetermined_message();
}

void Run::show_progress() {
  if (stopped() || !observer_) return;
  const Progress progress{t_, static_cast<long>(statistics_.steps), static_cast<long>(recorder_.events())};
  if (observer_(progress) == Continue::no) {
    stop(result::Termination::stopped_by_user, fmt::format("stopped at t = {:.10g}", t_));
  }
}

bool Run::step_counts() {
  ++statistics_.steps;
  return within_max_steps();
}

bool Run::within_max_steps() {
  if (statistics_.steps + statistics_.rejected < options_.max_steps) return true;
  stop(result::Termination::iteration_limit,
       fmt::format("max_steps = {} reached at t = {:.10g} ({} elements, {} tries that were divided); raise "
                   "simulate.max_steps or take fewer steps",
                   options_.max_steps, t_, statistics_.steps, statistics_.rejected));
  return false;
}

void Run::reject() {
  ++statistics_.rejected;
  if (within_max_steps()) show_progress();
}

void Run::hold_behind() {
  held_before_.assign(held_.data(), held_.data() + facts_.held.size());
  if (held_.set_behind(t_, nominal_, x_.data()) == HeldValues::Change::none) return;
  if (propagation_ != nullptr && t_ < options_.until) {
    propagation_->held_changed(t_, x_.data(), selections_.data(), held_before_.data(), held_.data());
  }
  previous_.reset();
  const ActiveSet before = set_;
  const auto selections = selections_;
  const std::size_t events = recorder_.events();
  decide({}, "a function of time changed", before, selections, held_before_.data());
  if (stopped() || recorder_.events() > events || !recorder_.ends_at(t_)) return;
  // Inputs and outputs are continuous from the right: a row asked for has the values behind a break, steps have both.
  const bool both = options_.rows == IntegrationOptions::Rows::at_elements;
  recorder_.row_behind(both ? Recorder::RowBefore::kept : Recorder::RowBefore::replaced, set_, selections_,
                       held_.data());
}

void Run::decide(std::vector<int> at_zero, std::string_view reason, const ActiveSet& before,
                 const std::vector<double>& selections_before, const double* held_before) {
  if (decided_at_ != t_) decisions_here_ = 0;
  decided_at_ = t_;
  constexpr int most_decisions = 20;
  if (++decisions_here_ > most_decisions) {
    if (go_to_limit(LapSeries::Wanted::soon)) return;
    stop(result::Termination::not_converged,
         fmt::format("the modes at t = {:.10g} change without end; try other simulate.fesd.steps", t_));
    return;
  }
  const auto found =
      transition_.continuations({t_, x_, held_.data(), &before, at_zero, size_, nominal_ / options_.elements / 128.0});
  if (found.empty() && go_to_limit(LapSeries::Wanted::soon)) return;
  if (found.empty() && stopped_where_not_finite()) return;
  if (found.empty() && can_fall_back()) {
    undecided_ = true;
    return;
  }
  if (found.empty()) {
    stop(result::Termination::no_admissible_mode,
         fmt::format("no mode continues the solution at t = {:.10g}; try method = \"event\"", t_));
    return;
  }
  recorder_.switched(t_, x_, {&before, &selections_before, held_before}, found, held_.data(), reason);
  continue_with(found);
  previous_.reset();
  fire_events_here();
  if (static_cast<long>(recorder_.events()) >= options_.max_events) {
    stop(result::Termination::iteration_limit,
         fmt::format("max_events = {} reached at t = {:.10g}; raise simulate.max_events if they are meant",
                     options_.max_events, t_));
  }
}

void Run::emit_times(const Element* element, const std::vector<double>& selections, double until) {
  const bool given = options_.rows == IntegrationOptions::Rows::at_times;
  if (given && options_.clock) return emit_clock_times(*element, selections, until);
  const auto& times = given ? options_.times : chosen_times_;
  for (; next_time_ < times.size() && times[next_time_] < until; ++next_time_) {
    const double time = times[next_time_];
    event_state(*element, selections, (time - element->t) / element->h);
    recorder_.row(time, between_x_, set_, between_selections_, held_.data());
  }
}

void Run::choose_times(const Element& element, const std::vector<double>& selections) {
  const std::size_t before_selections = facts_.n_x + facts_.n_u + facts_.n_y;
  if (!ranges_) {
    const ode::Tolerances floor{1e-9, 1e-12};  // of states that do nothing
    ranges_.emplace(before_selections + facts_.n_functions, options_.straight, floor);
  }
  const auto columns_at = [&](double theta, double* columns) {
    const double t = element.t + theta * element.h;
    event_state(element, selections, theta);
    columns = std::copy(between_x_.begin(), between_x_.end(), columns);
    functions_.inputs(t, held_.data(), columns);
    columns += facts_.n_u;
    functions_.outputs(t, between_x_.data(), between_selections_.data(), held_.data(), columns);
    columns += facts_.n_y;
    const auto view = recorder_.view(set_, between_selections_, held_.data());
    std::copy(view.alpha.begin(), view.alpha.end(), columns);
  };
  tolerance_.resize(ranges_->size());
  for (const double theta : {0.0, 1.0}) {
    columns_at(theta, tolerance_.data());
    for (std::size_t k = 0; k < tolerance_.size(); ++k) ranges_->widen(k, tolerance_[k]);
  }
  for (std::size_t k = 0; k < tolerance_.size(); ++k) tolerance_[k] = ranges_->tolerance(k);
  chosen_times_.clear();
  next_time_ = 0;
  for (const double theta : lines_.points(columns_at, 1.0, 2, tolerance_)) {
    const double t = element.t + theta * element.h;
    if (t > t_) chosen_times_.push_back(t);
  }
}

/// The row at the end of an element, unless an event has put it there.
void Run::row_here() {
  const bool at_times = options_.rows == IntegrationOptions::Rows::at_times;
  const double now = options_.clock ? x_[*options_.clock] : t_;
  const bool asked = at_times && next_time_ < options_.times.size() && options_.times[next_time_] == now;
  if (asked) ++next_time_;
  if (recorder_.ends_at(t_)) return;
  if (asked || !at_times) {
    recorder_.row(t_, x_, set_, selections_, held_.data());
  }
}

void Run::accept(const Element& element, const std::vector<double>& left, const std::vector<double>& right,
                 double end) {
  if (options_.straight > 0.0) choose_times(element, left);
  if (user_events_.empty()) {
    emit_times(&element, left, end);
  } else if (!record_user_events(element, left, end)) {
    return;
  }
  if (element_recorder_) element_recorder_->add(element, left, right, end, set_, held_.data());
  t_ = end;
  x_ = element.end;
  selections_ = right;
  // Halved with every element: what was large a long time ago has left no roundings.
  size_ = std::max(0.5 * size_, element.size);
  if (!step_counts() || user_events_.empty()) return;
  // Functions at zero at the start have a sign from now on.
  fire(user_events_.update(t_, x_.data(), selections_.data(), held_.data(), std::nullopt), t_, x_, selections_);
}

void Run::accept_chain(std::size_t count, double end_time, const Condition* closing) {
  if (propagation_ != nullptr) {
    propagation_->chain({chain_.elements.data(), count}, {chain_.left.data(), count + 1}, set_, held_.data(), closing,
                        changing_at(end_time));
    ends_fixed_ = closing == nullptr && !changing_at(end_time);
  }
  for (std::size_t i = 0; i < count && !stopped(); ++i) {
    const Element& element = chain_.elements[i];
    if (determined_) coarseness_.note(element, chain_.errors[i]);
    accept(element, chain_.left[i], chain_.left[i + 1], i + 1 == count ? end_time : element.t + element.h);
    if (i + 1 == count) break;
    row_here();
  }
  previous_ = chain_.elements[count - 1];
}

}  // namespace saltus::fesd_integrator
