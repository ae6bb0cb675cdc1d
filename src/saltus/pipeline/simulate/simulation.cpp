#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "saltus/base/at.hpp"
#include "saltus/base/symbolic_lock.hpp"
#include "saltus/model/system.hpp"
#include "saltus/pipeline/options/option_effects.hpp"
#include "saltus/pipeline/options/option_fields.hpp"
#include "saltus/pipeline/simulate/dropped_under_lock_internal.hpp"
#include "saltus/pipeline/simulate/kept_columns_internal.hpp"
#include "saltus/pipeline/simulate/output_rows_internal.hpp"
#include "saltus/pipeline/simulate/simulation_internal.hpp"

namespace saltus::pipeline {
namespace {

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

/// The result without its run, and with the columns that are kept.
Expected<result::Result> frame(const model::System& system, const SimulateOptions& options) {
  auto result = begin_result(system, name(options.method));
  for (std::size_t i = 0; i < system.parameter_names.size(); ++i) {
    result.model.parameters.emplace_back(system.parameter_names[i], system.parameter_values[i]);
  }
  for (std::size_t i = 0; i < result.states.size(); ++i) {
    result.model.initial_state.emplace_back(system.state_names[i], system.initial_state[i]);
  }
  result.options = option_record(options);
  auto kept = kept_columns(result, options.kept);
  if (!kept) return tl::unexpected(kept.error());
  result.kept = std::move(*kept);
  return result;
}

}  // namespace

std::shared_ptr<const model::System> own_copy(const model::System& system) {
  const SymbolicLock lock;
  return dropped_under_lock(model::System(system));
}

result::Result begin_result(const model::System& system, std::string_view method) {
  result::Result result;
  result.model.name = system.name;
  result.model.description = system.description;
  result.method = method;
  result.states = system.state_names;
  for (const auto& contact : system.contacts.contacts) result.contacts.push_back(contact.name);
  result.controls = system.control_names;
  result.outputs = system.output_names;
  for (const auto& column : system.columns) result.switching_functions.push_back(column.name);
  for (const auto& group : system.mode_groups) {
    if (group.first >= 0) result.region_groups.push_back({group.name, group.mode_names});
  }
  return result;
}

Expected<Simulation> checked_simulation(const model::System& system, const SimulateOptions& options,
                                        const Observers& observers) {
  auto begun = frame(system, options);
  if (!begun) return tl::unexpected(begun.error());
  if (const auto problem = find_problem(options)) return tl::unexpected(problem->error);
  auto forced = forced_modes(system, options);
  if (!forced) return tl::unexpected(forced.error());
  auto scaling = surface_scaling(system, options);
  if (!scaling) return tl::unexpected(scaling.error());
  SimulateOptions with_end = options;
  with_end.until = end_time(options);
  auto times = row_times(options.output, options.from, *with_end.until);
  return Simulation{
      system,           std::move(with_end), observers,           std::move(*begun),
      std::move(times), std::move(*forced),  std::move(*scaling), !system.contacts.empty() || !system.drawing.empty()};
}

void finish_result(const model::System& system, result::Result& result) {
  add_penetration(system, result);
  keep_columns(system, result);
}

}  // namespace saltus::pipeline
