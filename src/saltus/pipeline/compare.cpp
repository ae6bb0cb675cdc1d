#include "saltus/pipeline/compare.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "saltus/pipeline/option_fields.hpp"
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

bool is_stiff(const SimulateOptions& options) { return options.event.integrator == Integrator::radau5; }

PlannedRun event_run(SimulateOptions options, Integrator integrator, std::string variant) {
  const bool hopeless = is_stiff(options) && integrator != Integrator::radau5;
  options.method = Method::event;
  options.event.integrator = integrator;
  return {"event", std::move(variant), std::move(options),
          hopeless ? "the model asks for radau5: it is stiff, and this method is explicit" : ""};
}

PlannedRun reference_run(const SimulateOptions& options) {
  auto tight = reference_options(options);
  auto variant =
      fmt::format("{}, rtol {:g}, atol {:g}", is_stiff(options) ? "radau5" : "dop853", tight.rtol, tight.atol);
  return {"event", std::move(variant), std::move(tight), ""};
}

/// The reference first.
std::vector<PlannedRun> plan(SimulateOptions options) {
  options.event.trajectories = 1;
  std::vector<PlannedRun> runs{reference_run(options)};
  // Only the reference is drawn: rows of the others would be thrown away.
  options.output = AtTimes{{*options.until}};
  runs.push_back(event_run(options, Integrator::dopri5, "dopri5"));
  runs.push_back(event_run(options, Integrator::dop853, "dop853"));
  runs.push_back(event_run(options, Integrator::radau5, "radau5"));
  const auto add = [&](Method method, std::string name, std::string variant) {
    options.method = method;
    runs.push_back({std::move(name), std::move(variant), options, ""});
  };
  add(Method::smoothed, "smoothed", fmt::format("radau5, epsilon {:g}", options.smoothed.epsilon));
  add(Method::fesd, "fesd", "");
  add(Method::timestepping, "timestepping", "");
  return runs;
}

bool is_switch(const result::Event& event) { return event.kind != EventKind::start && event.kind != EventKind::user; }

/// The run as a row. The events of a smoothed system are borders of layers, not switches.
ComparedRun row(const PlannedRun& planned, const result::Result& found, const result::Result& reference) {
  ComparedRun run{planned.method, planned.variant, "", found.status, found.final.x, {}, {}, {}, {}, found.statistics};
  const auto [state, time] = agreement(found, reference);
  run.state_difference = state;
  if (planned.options.method == Method::smoothed) return run;
  const auto times = switch_times(found);
  run.switches = static_cast<std::int64_t>(times.size());
  if (!times.empty()) run.last_switch = times.back();
  run.switch_time_difference = time;
  return run;
}

/// Every run of a comparison is one trajectory for those who watch.
Observers numbered(const Observers& observers, long number, long runs, bool& stopped) {
  Observers inner;
  if (!observers.on_step) return inner;
  inner.on_step = [&observers, &stopped, number, runs](StepRecord step) {
    step.trajectory = number;
    step.trajectories = runs;
    const auto answer = observers.on_step(step);
    stopped = stopped || answer == Proceed::stop;
    return answer;
  };
  return inner;
}

}  // namespace

SimulateOptions reference_options(SimulateOptions options) {
  const bool stiff = is_stiff(options);
  options.method = Method::event;
  options.event.integrator = stiff ? Integrator::radau5 : Integrator::dop853;
  options.event.trajectories = 1;
  // The explicit method of order 8 gains down to here; the implicit one of order 5 would only take more steps.
  options.rtol = stiff ? 1e-12 : 1e-13;
  options.atol = stiff ? 1e-14 : 1e-15;
  return options;
}

std::vector<double> switch_times(const result::Result& result) {
  std::vector<double> times;
  for (const auto& event : result.events) {
    if (is_switch(event)) times.push_back(event.t);
  }
  return times;
}

Agreement agreement(const result::Result& found, const result::Result& reference) {
  const auto largest = [](const std::vector<double>& a, const std::vector<double>& b) -> std::optional<double> {
    if (a.size() != b.size()) return std::nullopt;
    double most = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) {
      // max would drop the NaN of a component without a value
      if (const double difference = std::abs(a[i] - b[i]); !(difference <= most)) most = difference;
    }
    return std::isfinite(most) ? std::optional(most) : std::nullopt;
  };
  if (!is_done(found.status.termination) || !is_done(reference.status.termination)) return {};
  return {largest(found.final.x, reference.final.x), largest(switch_times(found), switch_times(reference))};
}

Expected<result::Result> compare(const model::System& system, const SimulateOptions& options,
                                 const Observers& observers) {
  if (const auto problem = find_problem(options)) return tl::unexpected(problem->error);
  const auto planned = plan(options);
  const auto count = static_cast<long>(planned.size());
  bool stopped = false;
  auto reference = simulate(system, planned.front().options, numbered(observers, 1, count, stopped));
  if (!reference) return reference;
  result::Comparison comparison;
  comparison.runs.push_back(row(planned.front(), *reference, *reference));
  for (long number = 2; number <= count; ++number) {
    const auto& next = planned[static_cast<std::size_t>(number - 1)];
    auto refusal = stopped ? std::string("stopped by the user before it began") : next.refusal;
    if (refusal.empty()) {
      const auto found = simulate(system, next.options, numbered(observers, number, count, stopped));
      if (found) {
        comparison.runs.push_back(row(next, *found, *reference));
        continue;
      }
      refusal = found.error().message;
    }
    ComparedRun run{next.method, next.variant, std::move(refusal), {}, {}, {}, {}, {}, {}, {}};
    comparison.runs.push_back(std::move(run));
  }
  reference->command = "compare";
  reference->comparison = std::move(comparison);
  return reference;
}

}  // namespace saltus::pipeline
