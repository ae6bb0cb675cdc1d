#include "saltus/cli/check_text.hpp"

#include <cmath>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "saltus/base/at.hpp"
#include "saltus/cli/optimize_text.hpp"
#include "saltus/cli/reformulation_text.hpp"
#include "saltus/model/build.hpp"
#include "saltus/reformulation/dcs.hpp"
#include "saltus/smoothed/regularise.hpp"

namespace saltus::cli {
namespace {

std::string bounds(double lower, double upper) {
  if (std::isinf(lower) && std::isinf(upper)) return "";
  return fmt::format("  in [{}, {}]", lower, upper);
}

std::string heading(std::string_view title, std::size_t count) { return fmt::format("\n{} ({})\n", title, count); }

std::string still_text(const model::System& system, std::size_t state) {
  if (!system.discrete_states[state]) return "";
  for (const auto& jump : system.jumps) {
    for (const int target : jump.targets) {
      if (target == static_cast<int>(state)) return "  discrete: changed by jumps only";
    }
  }
  return "  constant: its right-hand side is 0 and no jump sets it";
}

std::string states_text(const model::System& system) {
  std::string text = heading("states", system.state_names.size());
  for (std::size_t i = 0; i < system.state_names.size(); ++i) {
    text += fmt::format("  {} = {}{}{}\n", system.state_names[i], system.initial_state[i],
                        bounds(system.state_lower[i], system.state_upper[i]), still_text(system, i));
  }
  return text;
}

std::string parameters_text(const model::System& system) {
  std::string text = heading("parameters", system.parameter_names.size());
  for (std::size_t i = 0; i < system.parameter_names.size(); ++i) {
    text += fmt::format("  {} = {}\n", system.parameter_names[i], system.parameter_values[i]);
  }
  return text;
}

std::string controls_text(const model::System& system) {
  std::string text = heading("controls", system.control_names.size());
  for (std::size_t i = 0; i < system.control_names.size(); ++i) {
    text += fmt::format("  {} = {}{}\n", system.control_names[i], system.control_initial[i],
                        bounds(system.control_lower[i], system.control_upper[i]));
  }
  return text;
}

std::string_view role_text(model::SwitchingRole role) {
  switch (role) {
    case model::SwitchingRole::listed:
      return "listed: a column of the result, where the field may jump";
    case model::SwitchingRole::kink:
      return "kink: the integrator restarts there, nothing slides";
    case model::SwitchingRole::time_event:
      return "time event: the integrator restarts there";
    case model::SwitchingRole::discrete:
      return "discrete: changed by jumps only, nothing slides";
    case model::SwitchingRole::region:
      return "region: where its indicator is the smallest of its group";
  }
  __builtin_unreachable();
}

std::string nesting(const model::System& system, const model::SwitchingFunction& function) {
  if (function.inner.empty()) return "";
  std::vector<std::string> names;
  for (const int index : function.inner) names.push_back(system.switching[at(index)].name);
  return fmt::format("; contains the selection of {}", fmt::join(names, ", "));
}

/// A column whose function was named before under another name.
std::string alias_text(const model::System& system, const model::SwitchingColumn& column) {
  const auto& function = system.switching[at(column.function)];
  return fmt::format("  {}: alias of {}{}\n", column.name, function.name,
                     column.orientation < 0 ? ", with the sides swapped" : "");
}

std::string function_text(const model::System& system, const model::SwitchingFunction& function) {
  return fmt::format("  {}: {}{}\n", function.name, role_text(function.role), nesting(system, function));
}

/// The columns of a result first and in their order, then what has no column.
std::string switching_text(const model::System& system) {
  std::string text = heading("switching functions", system.switching.size());
  std::vector<bool> shown(system.switching.size(), false);
  for (const auto& column : system.columns) {
    const auto index = static_cast<std::size_t>(column.function);
    const auto& function = system.switching[index];
    text += column.name == function.name ? function_text(system, function) : alias_text(system, column);
    shown[index] = true;
  }
  for (std::size_t i = 0; i < shown.size(); ++i) {
    if (!shown[i]) text += function_text(system, system.switching[i]);
  }
  return text;
}

std::string cell_text(const model::Cell& cell) {
  if (cell.table->kind == model::CellTable::Breaks::integers) return "jumps at whole numbers of its argument";
  const auto breaks = cell.table->breaks.size();
  return fmt::format("{} at {} break{}", cell.table->change == model::CellTable::Change::jump ? "jumps" : "kinks",
                     breaks, breaks == 1 ? "" : "s");
}

/// Tables, floor and mod, samples of inputs.
std::string cells_text(const model::System& system) {
  if (system.cells.empty()) return "";
  std::string text = heading("piecewise functions", system.cells.size());
  for (const auto& cell : system.cells) text += fmt::format("  {}: {}\n", cell.name, cell_text(cell));
  return text + "  the integrator restarts where an argument leaves its piece\n";
}

std::string modes_text(const model::System& system) {
  if (system.mode_groups.empty()) return "";
  std::string text = heading("groups of modes", system.mode_groups.size());
  for (const auto& group : system.mode_groups) {
    const std::string name = group.name.empty() ? "(without name)" : group.name;
    text += fmt::format("  {}: {} region{}\n", name, group.regions, group.regions == 1 ? "" : "s");
    if (group.first >= 0) {
      text += fmt::format("    by the smallest indicator: {}\n", fmt::join(group.mode_names, ", "));
    }
  }
  return text;
}

std::string inclusion_text(const model::System& system) {
  const bool filippov = system.inclusion == model::Inclusion::filippov;
  std::string text = fmt::format("\ninclusion: {}\n", filippov ? "filippov" : "aizerman_pyatnitskii");
  text += fmt::format("  the right-hand side as written is {}multi-affine in the selections\n",
                      system.multi_affine ? "" : "not ");
  if (system.inclusion_differences.empty()) {
    text += "  filippov and aizerman_pyatnitskii are the same for this model\n";
  } else {
    text += fmt::format("  filippov and aizerman_pyatnitskii differ in: {}\n",
                        fmt::join(system.inclusion_differences, ", "));
  }
  return text;
}

/// Which methods can run the model.
std::string methods_text(const model::System& system) {
  const auto regularisation = smoothed::regularise(system, pipeline::SmoothedOptions{}.epsilon);
  const auto dcs = reformulation::reformulate(system);
  std::string text =
      fmt::format("\nmethods: event{}{}\n", regularisation ? ", smoothed" : "", dcs ? ", fesd, timestepping" : "");
  if (!regularisation) text += fmt::format("  smoothed: {}\n", regularisation.error().message);
  if (!dcs) text += fmt::format("  fesd, timestepping: {}\n", dcs.error().message);
  return text;
}

std::string events_text(const model::System& system) {
  if (system.events.empty()) return "";
  std::string text = heading("events", system.events.size());
  for (const auto& event : system.events) {
    text += fmt::format("  {}{}\n", event.name, event.action == model::AtEvent::stop ? ": stops the simulation" : "");
  }
  return text;
}

std::string trigger_text(const model::Jump& jump) {
  switch (jump.trigger) {
    case model::JumpTrigger::condition:
      return "when its condition becomes true";
    case model::JumpTrigger::guard_down:
      return "when its guard falls below 0";
    case model::JumpTrigger::guard_up:
      return "when its guard rises above 0";
    case model::JumpTrigger::guard_both:
      return "when its guard passes 0";
    case model::JumpTrigger::times:
      break;
  }
  return jump.every > 0.0 ? fmt::format("every {}", jump.every)
                          : fmt::format("at {} given time{}", jump.times.size(), jump.times.size() == 1 ? "" : "s");
}

std::string jumps_text(const model::System& system) {
  if (system.jumps.empty()) return "";
  std::string text = heading("jumps", system.jumps.size());
  for (const auto& jump : system.jumps) {
    std::vector<std::string> targets;
    for (const int target : jump.targets) targets.push_back(system.state_names[at(target)]);
    text += fmt::format("  {}: {}; sets {}\n", jump.name, trigger_text(jump), fmt::join(targets, ", "));
  }
  return text;
}

std::string description_of(const model::System& system, const std::string& path,
                           const pipeline::SimulateOptions& options, const pipeline::Observers& observers) {
  const std::string_view colon = system.description.empty() ? "" : ": ";
  std::string text = fmt::format("{}{}{}\n{}\n", system.name, colon, system.description, path);
  text += states_text(system) + parameters_text(system) + controls_text(system) + switching_text(system);
  text += cells_text(system) + modes_text(system) + events_text(system) + jumps_text(system) + inclusion_text(system) +
          methods_text(system) + reformulation_text(system) + ranks_text(system, options, observers);
  text += heading("warnings", system.warnings.size());
  for (const auto& warning : system.warnings) text += fmt::format("  {}\n", warning);
  return text;
}

}  // namespace

Expected<std::string> check_text(const ModelInput& input, const pipeline::Observers& observers) {
  const auto system = model::build(input.file.description, input.overrides);
  if (!system) return tl::unexpected(system.error());
  auto optimization = optimize_text(input);
  if (!optimization) return optimization;
  return description_of(*system, input.path, input.file.simulate, observers) + *optimization;
}

}  // namespace saltus::cli
