#include "saltus/pipeline/compare.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "saltus/base/at.hpp"
#include "saltus/model/layout_of.hpp"
#include "saltus/pipeline/observers_internal.hpp"
#include "saltus/pipeline/options/option_fields.hpp"
#include "saltus/pipeline/recorded_internal.hpp"
#include "saltus/pipeline/values_at.hpp"
#include "saltus/result/comparison.hpp"

namespace saltus::pipeline {
namespace {

using result::ComparedRun;
using result::EventKind;

struct PlannedRun {
  std::string method;
  std::string variant;
  SimulateOptions options;
  std::string refusal;  ///< why it is not worth trying
};

bool is_implicit(Integrator integrator) { return ode::is_implicit(named_method(integrator)); }

PlannedRun event_run(SimulateOptions options, Integrator integrator, std::string variant) {
  const bool hopeless = is_implicit(options.event.integrator) && !is_implicit(integrator);
  options.method = Method::event;
  options.event.integrator = integrator;
  return {"event", std::move(variant), std::move(options),
          hopeless ? "the model is stiff by its integrator, and this method is explicit" : ""};
}

PlannedRun reference_run(const SimulateOptions& options) {
  auto tight = reference_options(options);
  auto variant = reference_name(tight);
  return {"event", std::move(variant), std::move(tight), ""};
}

/// "radau_iia 2, step, 100 steps"
std::string elements_text(const SimulateOptions& options, const std::string& method) {
  const auto record = option_record(options);
  const auto number = [&](const char* key) { return recorded<std::int64_t>(record, method + key).value_or(0); };
  return fmt::format("{} {}, {}, {} steps", recorded<std::string>(record, method + ".scheme").value_or(""),
                     number(".stages"), recorded<std::string>(record, method + ".reformulation").value_or(""),
                     number(".steps"));
}

/// Rows of runs at which they can be compared where one of them does not get to the end.
constexpr int compared_rows = 200;

std::vector<double> times_to_compare(double from, double until) {
  std::vector<double> times;
  for (int i = 1; i < compared_rows; ++i) times.push_back(from + (until - from) * i / compared_rows);
  times.push_back(until);
  return times;
}

/// Whether `smoothed` is another method than `event`.
bool is_regularised(const model::System& system) {
  const auto layout = model::layout_of(system);
  return std::any_of(layout.surfaces.begin(), layout.surfaces.end(),
                     [](const auto& surface) { return surface.role != model::SwitchingRole::discrete; });
}

/// The reference first.
std::vector<PlannedRun> plan(const model::System& system, SimulateOptions options) {
  options.until = end_time(options);
  options.event.trajectories = 1;
  options.kept = {};  // all states are compared
  std::vector<PlannedRun> runs{reference_run(options)};
  // Only the reference is drawn; the others have rows where they can be compared.
  options.output = AtTimes{times_to_compare(options.from, *options.until)};
  runs.push_back(event_run(options, Integrator::dopri5, "dopri5"));
  runs.push_back(event_run(options, Integrator::dop853, "dop853"));
  runs.push_back(event_run(options, Integrator::radau5, "radau5"));
  runs.push_back(event_run(options, Integrator::taylor, "taylor"));
  const auto add = [&](Method method, std::string name, std::string variant) {
    options.method = method;
    runs.push_back({std::move(name), std::move(variant), options, ""});
  };
  add(Method::smoothed, "smoothed", fmt::format("radau5, epsilon {:g}", options.smoothed.epsilon));
  if (!is_regularised(system)) runs.back().refusal = "it smooths switching functions, and this model has none";
  for (const auto form : {Reformulation::step, Reformulation::stewart}) {
    options.fesd.reformulation = form;
    add(Method::fesd, "fesd", elements_text(options, "fesd"));
  }
  add(Method::timestepping, "timestepping", elements_text(options, "timestepping"));
  return runs;
}

bool is_switch(const result::Event& event) { return event.kind != EventKind::start && event.kind != EventKind::user; }

std::optional<double> largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  if (a.size() != b.size()) return std::nullopt;
  double most = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    // max would drop the NaN of a component without a value
    if (const double difference = std::abs(a[i] - b[i]); !(difference <= most)) most = difference;
  }
  return std::isfinite(most) ? std::optional(most) : std::nullopt;
}

/// Times of the changes of mode and of the jumps; without starts and user events, which are no switches.
std::vector<double> switch_times(const result::Result& result) {
  std::vector<double> times;
  for (const auto& event : result.events) {
    if (is_switch(event)) times.push_back(event.t);
  }
  return times;
}

/// A run as a row without its states. The events of a smoothed system are borders of layers, not switches.
ComparedRun row(const PlannedRun& planned, const result::Result& found, const result::Result& reference) {
  ComparedRun run{planned.method, planned.variant, "", found.status, {}, {}, {}, {}, {}, found.statistics};
  if (planned.options.method == Method::smoothed) return run;
  const auto times = switch_times(found);
  run.switches = static_cast<std::int64_t>(times.size());
  if (!times.empty()) run.last_switch = times.back();
  run.switch_time_difference = agreement(found, reference).switch_time_difference;
  return run;
}

/// Runs as rows, and their states at the times of comparison until all have been made.
class ComparedStates {
 public:
  ComparedStates(double from, double until) : from_(from), until_(until) {}

  /// The states of the last run of `comparison`.
  void add(const result::Result& found) { states_.push_back({found.final.t, found.final.x, found.trajectory}); }
  void add_none() { states_.emplace_back(); }

  /// The end; or, where a run stopped early, the last time that all reach which got to a hundredth of the way.
  [[nodiscard]] std::optional<double> common_time() const {
    double reached = until_;
    for (const auto& one : states_) {
      if (one.t - from_ >= 0.01 * (until_ - from_)) reached = std::min(reached, one.t);
    }
    if (reached == until_) return until_;
    const auto times = times_to_compare(from_, until_);
    const auto behind = std::upper_bound(times.begin(), times.end(), reached);
    return behind == times.begin() ? std::nullopt : std::optional(*std::prev(behind));
  }

  /// Of one run at the common time; empty where it has none.
  [[nodiscard]] std::vector<double> at_time(std::size_t run, double t) const {
    const auto& one = states_[run];
    if (one.t == t) return one.x;
    const auto place = std::find(one.rows.t.rbegin(), one.rows.t.rend(), t);
    return place == one.rows.t.rend() ? std::vector<double>{}
                                      : std::vector<double>(one.rows.x[at(one.rows.t.rend() - place) - 1]);
  }

 private:
  struct Run {
    double t = -std::numeric_limits<double>::infinity();
    std::vector<double> x;
    result::Trajectory rows;
  };
  double from_, until_;
  std::vector<Run> states_;
};

/// States at one time, and how far they are from the reference's there.
/// @param may_run_again  whether the reference may be run once more, where it has no row at that time
Expected<void> compare_states(const model::System& system, const SimulateOptions& reference,
                              const ComparedStates& states, bool may_run_again, result::Comparison& comparison) {
  comparison.time = states.common_time();
  if (!comparison.time) return {};
  auto expected = states.at_time(0, *comparison.time);
  if (expected.empty() && may_run_again) {  // the reference has rows of its own
    const auto there = values_at(system, reference, {*comparison.time});
    if (!there) return tl::unexpected(there.error());
    expected = there->x.front();
  }
  for (std::size_t i = 0; i < comparison.runs.size(); ++i) {
    auto& run = comparison.runs[i];
    run.x = i == 0 ? expected : states.at_time(i, *comparison.time);
    if (!run.x.empty()) run.state_difference = largest_difference(run.x, expected);
  }
  return {};
}

}  // namespace

SimulateOptions reference_options(SimulateOptions options) {
  const bool stiff = is_implicit(options.event.integrator);
  options.method = Method::event;
  if (options.event.integrator != Integrator::automatic)
    options.event.integrator = stiff ? Integrator::radau5 : Integrator::dop853;
  options.event.trajectories = 1;
  options.kept = {};
  // The explicit method of order 8 gains down to here; the implicit one of order 5 would only take more steps.
  options.rtol = stiff ? 1e-12 : 1e-13;
  options.atol = stiff ? 1e-14 : 1e-15;
  return options;
}

std::string reference_name(const SimulateOptions& reference) {
  const auto integrator = reference.event.integrator;
  const auto* name = integrator == Integrator::automatic ? "auto" : is_implicit(integrator) ? "radau5" : "dop853";
  return fmt::format("{}, rtol {:g}, atol {:g}", name, reference.rtol, reference.atol);
}

Agreement agreement(const result::Result& found, const result::Result& reference) {
  if (!is_done(found.status.termination) || !is_done(reference.status.termination)) return {};
  return {largest_difference(found.final.x, reference.final.x),
          largest_difference(switch_times(found), switch_times(reference))};
}

Expected<result::Result> compare(const model::System& system, const SimulateOptions& options,
                                 const Observers& observers) {
  if (const auto problem = find_problem(options)) return tl::unexpected(problem->error);
  const auto planned = plan(system, options);
  Numbered watch(observers, static_cast<long>(planned.size()));
  auto reference = simulate(system, planned.front().options, watch.next());
  if (!reference) return reference;
  result::Comparison comparison;
  comparison.runs.push_back(row(planned.front(), *reference, *reference));
  ComparedStates states(options.from, *end_time(options));
  states.add(*reference);
  for (std::size_t i = 1; i < planned.size(); ++i) {
    const auto& next = planned[i];
    const auto observed = watch.next();
    auto refusal = watch.stopped() ? std::string("stopped by the user before it began") : next.refusal;
    if (refusal.empty()) {
      const auto found = simulate(system, next.options, observed);
      if (found) {
        comparison.runs.push_back(row(next, *found, *reference));
        states.add(*found);
        continue;
      }
      refusal = found.error().message;
    }
    comparison.runs.push_back({next.method, next.variant, std::move(refusal), {}, {}, {}, {}, {}, {}, {}});
    states.add_none();
  }
  // Who stops a comparison does not wait for another run.
  const auto compared = compare_states(system, planned.front().options, states, !watch.stopped(), comparison);
  if (!compared) return tl::unexpected(compared.error());
  reference->command = "compare";
  reference->comparison = std::move(comparison);
  return reference;
}

}  // namespace saltus::pipeline
