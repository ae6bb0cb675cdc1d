#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "saltus/base/at.hpp"
#include "saltus/base/symbolic_lock.hpp"
#include "saltus/evaluation/model_kernel.hpp"
#include "saltus/event_integrator/impact_ends.hpp"
#include "saltus/model/decisions.hpp"
#include "saltus/model/frozen_system.hpp"
#include "saltus/model/layout_of.hpp"
#include "saltus/model/system.hpp"
#include "saltus/model/time_freezing/negative_friction.hpp"
#include "saltus/model/time_freezing/time_freezing.hpp"
#include "saltus/pipeline/continuous/continuous_internal.hpp"
#include "saltus/pipeline/simulate/methods_internal.hpp"
#include "saltus/pipeline/simulate/output_rows_internal.hpp"
#include "saltus/pipeline/time_freezing/physical_time_internal.hpp"

namespace saltus::pipeline {
namespace {

/// Numerical time in lengths of physical time: tried one after the other. Contacts that rest take a part of it, impacts
/// a little each.
constexpr double lengths[] = {2.0, 16.0, 256.0, 4096.0};

/// Of the length of a simulation step: where a gap is held at 0 by its selection the clock moves by its roundings.
constexpr double standing_part = 1e-9;

Error not_frozen(std::string message, std::string remedy) {
  return {ErrorCode::not_available, std::move(message), std::move(remedy), {}, {}};
}

/// The system that stops where its clock shows `until`.
model::System clocked(model::System system, double from, double until) {
  const int clock = system.freezing->clock;
  system.initial_state[at(clock)] = from;
  model::UserEvent end;
  end.name = "end";
  end.value = system.x(clock) - until;
  end.guards = end.guard_alpha = casadi::SX(0, 1);
  end.direction = model::Direction::up;
  end.action = model::AtEvent::stop;
  system.events.push_back(std::move(end));
  return system;
}

/// Rows at times that were asked for are at those times, not at their roundings.
/// @param events  whose rows stay at their times
void put_on_times(const std::vector<double>& times, double until, const std::set<double>& events,
                  result::Trajectory& rows) {
  for (double& t : rows.t) {
    const double rounding = 1e-13 * std::max(1.0, std::abs(until));
    const auto next = std::lower_bound(times.begin(), times.end(), t - rounding);
    if (next != times.end() && *next <= t + rounding && !events.contains(t)) t = *next;
    if (std::abs(t - until) <= rounding) t = until;
  }
}

/// The first row, the last, and both of every event: others are at values of a clock to its rounding.
result::Trajectory rows_at_events(result::Trajectory rows) {
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < rows.t.size(); ++i) {
    const bool last = i + 1 == rows.t.size();
    if (i == 0 || last || side(rows, i) == 1 || side(rows, i + 1) == 1) kept.push_back(i);
  }
  rows.keep(kept);
  return rows;
}

/// The contact whose friction has ended a run by turning negative.
std::optional<std::string> negative_friction(const result::Result& run) {
  if (run.status.termination != result::Termination::stopped_by_event || run.events.empty()) return std::nullopt;
  const std::string name = run.events.back().name.value_or(""), end = model::negative_friction;
  if (!name.ends_with(end)) return std::nullopt;
  return name.substr(0, name.size() - end.size());
}

/// Says of a run in numerical time how it ended at the time that its clock has reached.
void restate_status(double reached, double until, result::Result& run) {
  auto& status = run.status;
  const bool ended = status.termination == result::Termination::stopped_by_event && !run.events.empty() &&
                     run.events.back().name == "end";
  if (ended) {
    run.events.pop_back();
    status.termination = result::Termination::completed;
    status.message.clear();
  } else if (auto contact = negative_friction(run)) {
    run.events.pop_back();
    status.termination = result::Termination::outside_class;
    status.message =
        fmt::format("the friction of '{}' turns negative at t = {:.10g}, while bodies touch", *contact, reached);
  } else if (status.termination == result::Termination::completed) {
    status.termination = result::Termination::not_converged;
    status.message = "the clock stands still";
  } else if (status.termination != result::Termination::stopped_by_event && !status.message.empty()) {
    status.message += fmt::format(" (t is numerical time here; the clock shows {:.10g})", reached);
  }
  status.time_reached = ended ? until : reached;
}

/// Says of impacts whether they are unique, as the event engine says it of the same ones.
/// @return why the system was not compiled
std::optional<Error> compare_impacts(const model::System& system, result::Result& run) {
  const auto is_impact = [](const auto& event) { return event.kind == result::EventKind::impact; };
  const auto several = system.contacts.contacts.size() > 1;
  if (!several || std::none_of(run.events.begin(), run.events.end(), is_impact)) return std::nullopt;
  const auto kernel = evaluation::ModelKernel::compile(system);
  if (!kernel) return kernel.error();
  result::Events events;
  for (result::Event event : run.events) {
    if (is_impact(event) && event_integrator::may_end_elsewhere(*kernel, event)) {
      event.unique = false;
      event.reason += "; impacts one behind the other may end elsewhere";
    }
    events.push_back(std::move(event));
  }
  run.events = std::move(events);
  return std::nullopt;
}

}  // namespace

Expected<result::Result> simulate_frozen(const Simulation& asked) {
  const SymbolicLock lock;  // systems are made and dropped
  const auto& system = asked.system;
  const auto& options = asked.options;
  const auto& frozen = system.frozen->system();
  if (!frozen) return tl::unexpected(frozen.error());
  if (options.method != Method::fesd) {
    return tl::unexpected(not_frozen("the method \"timestepping\" does not cover contacts and hysteresis",
                                     "method = \"fesd\" or \"event\""));
  }
  if (options.fesd.sensitivities) {
    return tl::unexpected(
        not_frozen("there are no sensitivities with contacts or hysteresis", "leave simulate.fesd.sensitivities out"));
  }
  const double from = options.from, until = *options.until;
  const model::System made = clocked(model::with_values_of(*frozen, system), from, until);
  if (auto error = model::find_stale(made)) return tl::unexpected(*error);
  SimulateOptions numerical = options;
  numerical.event_rows = true;
  numerical.continuous = false;
  Expected<result::Result> run = asked.frame;
  for (const double length : lengths) {
    numerical.until = from + length * (until - from);
    numerical.fesd.steps = static_cast<long>(std::ceil(length * static_cast<double>(options.fesd.steps)));
    run = simulate_elements({made, numerical, asked.observers, asked.frame, asked.times, {}});
    if (!run || run->status.termination != result::Termination::completed) break;
  }
  if (!run) return run;
  restate_status(run->final.x[at(made.freezing->clock)], until, *run);
  const double standing = standing_part * (until - from) / static_cast<double>(options.fesd.steps);
  run->switching_functions = to_physical_time(model::layout_of(made), *made.freezing, standing, *run);
  if (auto error = compare_impacts(system, *run)) return tl::unexpected(*error);
  std::set<double> event_times;
  const bool with_event_rows = has_event_rows(options) || options.continuous;
  for (std::size_t i = 0; with_event_rows && i < run->events.size(); ++i) event_times.insert(run->events.t(i));
  put_on_times(asked.times, until, event_times, run->trajectory);
  if (options.continuous) {
    run->continuous = continuous(rows_at_events(run->trajectory), system, options, nullptr);
  }
  run->final.t = run->trajectory.t.back();
  if (!has_event_rows(options)) leave_out_event_rows(wanted_rows(options.output, asked.times), run->trajectory);
  return run;
}

}  // namespace saltus::pipeline
