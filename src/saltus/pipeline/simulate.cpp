#include "saltus/pipeline/simulate.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <type_traits>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "saltus/base/at.hpp"
#include "saltus/base/stopwatch.hpp"
#include "saltus/base/symbolic_lock.hpp"
#include "saltus/evaluation/model_kernel.hpp"
#include "saltus/event_integrator/integrate.hpp"
#include "saltus/model/decisions.hpp"
#include "saltus/model/mechanics/contacts_at_start.hpp"
#include "saltus/model/system.hpp"
#include "saltus/model/time_freezing/time_freezing.hpp"
#include "saltus/pipeline/branches_internal.hpp"
#include "saltus/pipeline/continuous/continuous_internal.hpp"
#include "saltus/pipeline/integrand_internal.hpp"
#include "saltus/pipeline/kept_columns_internal.hpp"
#include "saltus/pipeline/options/option_effects.hpp"
#include "saltus/pipeline/options/option_fields.hpp"
#include "saltus/pipeline/output_rows_internal.hpp"
#include "saltus/pipeline/passed_on_internal.hpp"
#include "saltus/pipeline/simulate_elements_internal.hpp"
#include "saltus/pipeline/step_observer_internal.hpp"
#include "saltus/pipeline/time_freezing/simulate_frozen_internal.hpp"

namespace saltus::pipeline {

evaluation::NativeCode native_code(Native native) {
  switch (native) {
    case Native::automatic:
      return evaluation::NativeCode::automatic;
    case Native::on:
      return evaluation::NativeCode::on;
    case Native::off:
      return evaluation::NativeCode::off;
  }
  __builtin_unreachable();
}

namespace {

using event_integrator::IntegrationOptions;

/// The switching function of a name in the options under `key`.
Expected<model::SwitchingColumn> find_column(const model::System& system, const std::string& key,
                                             const std::string& name) {
  std::vector<std::string> known;
  for (const auto& column : system.columns) {
    if (column.name == name) return column;
    known.push_back(column.name);
  }
  for (const auto& group : system.mode_groups)
    known.insert(known.end(), group.mode_names.begin(), group.mode_names.end());
  return tl::unexpected(
      with_context({ErrorCode::unknown_name, "unknown switching function '" + name + "'", suggest(name, known), {}, {}},
                   "in simulate." + key + "." + name));
}

/// The region of a group by `indicator` with this name: "mode", or "group.mode"; nullopt if there is none, or several.
std::optional<int> find_region(const model::System& system, const std::string& name) {
  std::optional<int> found;
  for (const auto& group : system.mode_groups) {
    for (int i = 0; group.first >= 0 && i < group.regions; ++i) {
      const auto& mode = group.mode_names[at(i)];
      if (name != mode && name != group.name + "." + mode) continue;
      if (found) return std::nullopt;
      found = group.first + i;
    }
  }
  return found;
}

Expected<std::vector<std::pair<int, int>>> forced_modes(const model::System& system, const SimulateOptions& options) {
  std::vector<std::pair<int, int>> forced;
  for (const auto& [name, mode] : options.initial_mode) {
    if (const auto region = find_region(system, name)) {
      forced.emplace_back(*region, mode);
      continue;
    }
    const auto found = find_column(system, "initial_mode", name);
    if (!found) return tl::unexpected(found.error());
    forced.emplace_back(found->function, found->orientation * mode);
  }
  return forced;
}

switching::SelectionPolicy selection_policy(Selection selection) {
  switch (selection) {
    case Selection::active_dominant:
      return switching::SelectionPolicy::active_dominant;
    case Selection::passive_dominant:
      return switching::SelectionPolicy::passive_dominant;
    case Selection::scaled:
      return switching::SelectionPolicy::scaled;
    case Selection::report:
      return switching::SelectionPolicy::report;
  }
  __builtin_unreachable();
}

/// One factor per switching function, or none.
Expected<std::vector<double>> surface_scaling(const model::System& system, const SimulateOptions& options) {
  std::vector<double> scaling;
  if (options.event.scaling.empty()) return scaling;
  scaling.assign(system.switching.size(), 1.0);
  for (const auto& [name, kappa] : options.event.scaling) {
    const auto found = find_column(system, "event.scaling", name);
    if (!found) return tl::unexpected(found.error());
    scaling[at(found->function)] = kappa;
  }
  return scaling;
}

Expected<IntegrationOptions> integration_options(const model::System& system, const SimulateOptions& options) {
  if (!options.until) {
    return tl::unexpected(Error{ErrorCode::invalid_option, "no end time", "set SimulateOptions::until", {}, {}});
  }
  if (const auto problem = find_problem(options)) return tl::unexpected(problem->error);
  IntegrationOptions integration;
  // The layers make every model stiff.
  integration.method = options.method == Method::smoothed ? Integrator::radau5 : options.event.integrator;
  integration.from = options.from;
  integration.until = *options.until;
  integration.tolerances = {options.rtol, options.atol};
  integration.max_step = options.event.max_step;
  integration.local_steps = options.event.local_steps;
  integration.max_steps = options.max_steps;
  integration.max_events = options.max_events;
  integration.output = output_times(options.output, integration.from, integration.until);
  auto forced = forced_modes(system, options);
  if (!forced) return tl::unexpected(forced.error());
  integration.initial_mode = std::move(*forced);
  integration.selection = selection_policy(options.event.selection);
  auto scaling = surface_scaling(system, options);
  if (!scaling) return tl::unexpected(scaling.error());
  integration.scaling = std::move(*scaling);
  return integration;
}

result::Result frame(const model::System& system, const SimulateOptions& options) {
  result::Result result;
  result.model.name = system.name;
  result.model.description = system.description;
  for (std::size_t i = 0; i < system.parameter_names.size(); ++i) {
    result.model.parameters.emplace_back(system.parameter_names[i], system.parameter_values[i]);
  }
  for (std::size_t i = 0; i < system.state_names.size(); ++i) {
    result.model.initial_state.emplace_back(system.state_names[i], system.initial_state[i]);
  }
  result.method = name(options.method);
  result.states = system.state_names;
  if (!system.contacts.empty()) {
    result.states.resize(at(system.contacts.first_hidden));
    result.model.initial_state.resize(result.states.size());
  }
  for (const auto& contact : system.contacts.contacts) result.contacts.push_back(contact.name);
  result.controls = system.control_names;
  result.outputs = system.output_names;
  for (const auto& column : system.columns) result.switching_functions.push_back(column.name);
  for (const auto& group : system.mode_groups) {
    if (group.first >= 0) result.region_groups.push_back({group.name, group.mode_names});
  }
  result.options = option_record(options);
  return result;
}

/// How deep bodies are in each other, by the outputs that contacts have.
void add_penetration(const model::System& system, result::Result& result) {
  if (system.contacts.empty()) return;
  double deepest = 0.0;
  for (const auto& contact : system.contacts.contacts) {
    const auto gap = std::find(result.outputs.begin(), result.outputs.end(), fmt::format("gap({})", contact.name));
    if (gap == result.outputs.end()) continue;
    const auto column = static_cast<std::size_t>(gap - result.outputs.begin());
    for (const auto row : result.trajectory.outputs) deepest = std::max(deepest, -row[column]);
  }
  result.penetration = deepest;
  for (auto& branch : result.branches) add_penetration(system, branch);
}

bool by_elements(const SimulateOptions& options) {
  return options.method == Method::fesd || options.method == Method::timestepping;
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

Expected<result::Result> simulated_by_elements(const model::System& system, const SimulateOptions& options,
                                               const IntegrationOptions& checked, const Observers& observers) {
  const SymbolicLock lock;  // its problems are made while it runs
  const auto& times = checked.output.times;
  if (!system.frozen) {
    return simulate_elements(system, options, times, checked.initial_mode, frame(system, options), observers);
  }
  SimulateOptions with_rows = options;
  with_rows.event_rows = options.event_rows || options.continuous;
  auto result = simulate_frozen(system, with_rows, times, frame(system, options), observers);
  if (!result || !options.continuous) return result;
  result->continuous = continuous(rows_at_events(result->trajectory), system, options, nullptr);
  if (!options.event_rows) leave_out_event_rows(times, result->trajectory);
  return result;
}

Expected<result::Result> simulated(const model::System& system, const SimulateOptions& options,
                                   const std::optional<result::KeptColumns>& kept_columns, const Observers& observers,
                                   KernelStore* kernels) {
  auto integration_or = integration_options(system, options);
  if (!integration_or) return tl::unexpected(integration_or.error());
  if (by_elements(options)) {
    return simulated_by_elements(system, options, *integration_or, observers);
  }
  Stopwatch stopwatch;
  const auto own = options.continuous ? own_copy(system) : nullptr;
  auto made = Integrand::make(own ? *own : system, options);
  if (!made) return tl::unexpected(made.error());
  const auto integrand = std::make_shared<const Integrand>(std::move(*made));
  integration_or->layers = integrand->layers();
  integration_or->output.selections = integrand->selections();
  integration_or->output.pieces = options.continuous;
  KernelStore of_this_run;
  if (kernels == nullptr) kernels = &of_this_run;
  auto kept = kernels->take(integrand->system(), native_code(options.native));
  if (!kept) return tl::unexpected(kept.error());

  auto integration = *integration_or;
  const bool passes_on = observers.on_part && options.method == Method::event && options.event.trajectories == 1 &&
                         !options.continuous && system.contacts.empty() && system.drawing.empty();
  const auto run_one = [&](const Path& path, const Count& count) -> Followed {
    const auto observer = step_observer(observers, {integration.from, integration.until, count.number, count.known});
    integration.choices = path;
    std::optional<PassingOn> passing;
    event_integrator::TakeRecorded take;
    if (passes_on) {
      auto of_parts = frame(system, options);
      of_parts.kept = kept_columns;
      passing.emplace(observers, of_parts, options.event_rows ? nullptr : &integration.output.times);
      take = [&](result::Trajectory rows, result::Events events) { passing->take(std::move(rows), std::move(events)); };
    }
    auto run = integrand->restated(event_integrator::integrate(kept->kernel, integration, observer, take));
    Followed followed{frame(system, options), std::move(run.branch_points), std::move(run.family_numbers), run.chosen};
    auto& result = followed.result;
    result.families = std::move(run.families);
    result.status = std::move(run.status);
    result.final = std::move(run.final);
    result.events = std::move(run.events);
    result.trajectory = std::move(run.trajectory);
    if (own) {
      const EventRun of_it{own, integrand, integration, native_code(options.native)};
      result.continuous = continuous(result.trajectory, of_it, kept->kernel, std::move(run.pieces));
    }
    if (passing) result.passed_on = passing->end();
    if (!options.event_rows) leave_out_event_rows(integration.output.times, result.trajectory);
    result.statistics = run.statistics;
    result.statistics.wall_seconds = stopwatch.seconds();
    stopwatch = {};
    return followed;
  };
  auto result = follow_branches(run_one, {options.event.trajectories, options.event.members});
  kernels->give_back(std::move(*kept));
  return result;
}

}  // namespace

Expected<result::Result> simulate(const model::System& system, const SimulateOptions& options,
                                  const Observers& observers, KernelStore* kernels) {
  if (auto error = model::find_stale(system)) return tl::unexpected(*error);
  {
    const SymbolicLock lock;
    if (auto error = model::check_contacts_at_start(system, options.from)) return tl::unexpected(*error);
  }
  const auto& other = system.frozen;
  if (options.method != Method::event && other && other->system && !other->system->freezing) {
    std::optional<model::System> as_written;
    {
      const SymbolicLock lock;
      as_written = model::with_values_of(*other->system, system);
    }
    auto result = simulate(*as_written, options, observers, kernels);
    const SymbolicLock lock;
    as_written.reset();
    return result;
  }
  const auto kept = kept_columns(frame(system, options), options.kept);
  if (!kept) return tl::unexpected(kept.error());
  auto result = simulated(system, options, *kept, observers, kernels);
  if (!result) return result;
  add_penetration(system, *result);
  if (*kept) keep_columns(system, **kept, *result);
  return result;
}

void leave_out_rows(const model::System& system, SimulateOptions& options) {
  const bool times_are_checked = std::holds_alternative<AtTimes>(options.output);
  if (options.method != Method::event || times_are_checked || !system.contacts.empty()) return;
  options.output = NumberOfPoints{2};
}

}  // namespace saltus::pipeline
