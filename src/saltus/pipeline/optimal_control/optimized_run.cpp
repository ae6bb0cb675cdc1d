#include "saltus/pipeline/optimal_control/optimized_run.hpp"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <utility>

#include "saltus/base/at.hpp"
#include "saltus/fesd_integrator/optimum_run.hpp"
#include "saltus/model/decisions.hpp"
#include "saltus/model/layout_of.hpp"
#include "saltus/model/ocp.hpp"
#include "saltus/pipeline/continuous/continuous_internal.hpp"
#include "saltus/pipeline/options/number_list_internal.hpp"
#include "saltus/pipeline/time_freezing/physical_time_internal.hpp"
#include "saltus/reformulation/dcs.hpp"

namespace saltus::pipeline {
namespace {

using discretization::OcpSolution;

/// The left ends of the intervals in the time of the right-hand side, then the end of the last one.
std::vector<double> node_times(double from, const OcpSolution& solution) {
  const auto intervals = solution.elements.size();
  std::vector<double> times{from};
  // As the elements' own times are added up.
  for (const double speed : solution.speed_of_time) {
    times.push_back(times.back() + speed * solution.horizon / static_cast<double>(intervals));
  }
  return times;
}

OptimizedPath path_of(const OcpSolution& solution, const std::vector<double>& times) {
  OptimizedPath path;
  path.horizon = solution.horizon;
  path.parameters = solution.parameters;
  path.times = times;
  path.controls = solution.controls;
  path.nodes.push_back(solution.initial_state);
  path.state_max = path.state_min = solution.initial_state;
  const auto include = [&](const auto& x) {
    for (std::size_t i = 0; i < path.state_max.size(); ++i) {
      path.state_max[i] = std::max(path.state_max[i], x[index(i)]);
      path.state_min[i] = std::min(path.state_min[i], x[index(i)]);
    }
  };
  for (const auto& interval : solution.elements) {
    double t = times[path.nodes.size() - 1];
    auto left = path.nodes.back();
    for (const auto& element : interval) {
      for (linalg::Index m = 0; m < element.states.cols(); ++m) include(element.states.col(m));
      include(element.end);
      path.elements.push_back({t, path.nodes.size() - 1, std::move(left)});
      left = list_of(element.end);
      t += element.h;
    }
    path.nodes.push_back(std::move(left));
  }
  return path;
}

/// What the problem has added to the model stays out of the result.
void keep_those_of_the_user(const model::Ocp& ocp, OptimizedRun& run) {
  const auto outputs = shown_outputs(ocp);
  run.trajectory.u.narrow(at(ocp.user_controls));
  run.trajectory.outputs.keep_columns(outputs);
  std::vector<double> shown;
  for (const std::size_t column : outputs) shown.push_back(run.final.outputs[column]);
  run.final.outputs = std::move(shown);
}

/// Rows and events of numerical time, in physical time.
void restore_physical_time(const model::Ocp& ocp, double standing, OptimizedRun& run) {
  result::Result rows;
  rows.trajectory = std::move(run.trajectory);
  rows.events = std::move(run.events);
  run.switching_functions = to_physical_time(model::layout_of(ocp.system), *ocp.system.freezing, standing, rows);
  run.trajectory = std::move(rows.trajectory);
  run.events = std::move(rows.events);
  run.final = std::move(rows.final);
}

}  // namespace

std::vector<std::size_t> shown_outputs(const model::Ocp& ocp) {
  std::vector<std::size_t> columns;
  const std::size_t hidden = ocp.system.freezing ? 1 : 0;  // the rate of the clock, the last one
  for (std::size_t i = 0; i + hidden < ocp.system.output_names.size(); ++i) {
    if (i < at(ocp.user_outputs) || i >= at(ocp.user_outputs + ocp.problem_outputs)) columns.push_back(i);
  }
  return columns;
}

Expected<OptimizedRun> optimized_run(const model::Ocp& ocp, const OcpSolution& solution,
                                     const reformulation::ReformulationOptions& form,
                                     const discretization::ButcherTableau& tableau) {
  const auto times = node_times(ocp.from, solution);
  model::System system = ocp.system;
  system.parameter_values = solution.parameters;
  system.initial_state = solution.initial_state;
  if (auto error = model::find_stale(system)) return tl::unexpected(*error);
  system.events.clear();  // an optimised point knows of none
  system = model::with_controls(std::move(system), {times.begin(), times.end() - 1}, solution.controls);
  const auto dcs = reformulation::reformulate(system, form);
  if (!dcs) return tl::unexpected(dcs.error());
  std::optional<fesd_integrator::OptimumClock> clock;
  if (ocp.clock) clock = {at(ocp.clock->state), system.freezing == nullptr};
  auto read = fesd_integrator::optimum_run(system, *dcs, solution, times, tableau, clock);
  if (!read) return tl::unexpected(read.error());

  OptimizedRun run;
  run.trajectory = std::move(read->trajectory);
  run.events = std::move(read->events);
  run.final = std::move(read->final);
  run.elements = std::move(read->elements);
  run.path = path_of(solution, times);
  run.path.events = std::move(read->events_of_all);
  if (ocp.system.freezing) restore_physical_time(ocp, fesd_integrator::standing_clock * solution.horizon, run);
  keep_those_of_the_user(ocp, run);
  if (clock) return run;
  run.continuous = continuous(run.trajectory, std::move(read->solution),
                              [controls = at(ocp.user_controls), outputs = shown_outputs(ocp)](auto& rows) {
                                rows.u.narrow(controls);
                                rows.outputs.keep_columns(outputs);
                              });
  return run;
}

}  // namespace saltus::pipeline
