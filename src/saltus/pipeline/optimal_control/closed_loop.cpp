// The controls of an optimum with feedback, simulated event by event.
#include <algorithm>
#include <cmath>
#include <utility>

#include "saltus/base/at.hpp"
#include "saltus/pipeline/optimal_control/resimulation_internal.hpp"
#include "saltus/pipeline/simulate.hpp"

namespace saltus::pipeline {
namespace {

using event_integrator::Integration;
using result::Termination;

/// The plant with what the optimisation has chosen: free parameters and initial values.
model::System optimised_plant(const model::Ocp& ocp, const OptimizedPath& path) {
  model::System system = ocp.plant ? *ocp.plant : ocp.system;
  const auto& start = path.nodes.front();
  for (std::size_t i = 0; i < path.parameters.size(); ++i) {
    if (!ocp.plant || ocp.free_parameters[i]) system.parameter_values[i] = path.parameters[i];
  }
  for (std::size_t i = 0; i < start.size(); ++i) {
    if (!ocp.plant || (i < ocp.free_states.size() && ocp.free_states[i])) system.initial_state[i] = start[i];
  }
  return system;
}

/// The system whose controls are its last parameters.
model::System with_parameters_as_controls(model::System system, const OptimizedPath& path) {
  const auto n = static_cast<casadi_int>(system.control_names.size());
  // Without the cells of its own inputs, and without those of the ones given here.
  system = model::with_controls(std::move(system), {path.times.front()}, {path.controls.front()});
  system.cells.resize(system.cells.size() - system.control_names.size());
  const casadi::SX controls = casadi::SX::sym("control", n);
  system.input = controls;
  system.p = casadi::SX::vertcat({system.p, controls});
  for (const auto& name : system.control_names) system.parameter_names.push_back("control." + name);
  system.parameter_values.resize(system.parameter_names.size(), 0.0);
  system.events.clear();  // they would stop it
  return system;
}

/// Rows of equal distance in each interval.
constexpr std::size_t rows_of_interval = 20;

/// The state of the plan that a state at node k is compared with: where the plan jumps there, the nearer one. A body
/// that lands a little later than planned is off by nothing, and not by the velocity that the collision takes.
const std::vector<double>& planned_state(const OptimizedPath& path, std::size_t k, const std::vector<double>& x) {
  const auto& behind = path.nodes[k];
  if (k == 0 || path.ends.empty()) return behind;
  const auto distance = [&](const std::vector<double>& planned) {
    double square = 0.0;
    for (std::size_t i = 0; i < path.state_max.size(); ++i) {
      const double range = path.state_max[i] - path.state_min[i];
      if (range > 0.0) square += std::pow((x[i] - planned[i]) / range, 2);
    }
    return square;
  };
  return distance(path.ends[k - 1]) < distance(behind) ? path.ends[k - 1] : behind;
}

}  // namespace

Expected<Resimulation::Segment> simulate_closed_loop(const model::Ocp& ocp, const OptimizedPath& path,
                                                     const std::vector<Eigen::MatrixXd>& gains,
                                                     const std::function<bool()>& is_interrupted) {
  model::System system = with_parameters_as_controls(optimised_plant(ocp, path), path);
  const std::size_t first = path.parameters.size();
  const auto observer = [&](const result::Progress&) {
    return is_interrupted && is_interrupted() ? result::Continue::no : result::Continue::yes;
  };
  KernelStore kernels;
  Resimulation::Segment whole;
  std::vector<double> x = system.initial_state;
  for (std::size_t k = 0; k < path.controls.size(); ++k) {
    const auto& planned = planned_state(path, k, x);
    Eigen::VectorXd off(gains[k].cols());
    for (Eigen::Index i = 0; i < off.size(); ++i) off[i] = x[at(i)] - planned[at(i)];
    const Eigen::VectorXd change = gains[k] * off;
    for (std::size_t i = 0; i < path.controls[k].size(); ++i) {
      const double u = path.controls[k][i] + change[index(i)];
      system.parameter_values[first + i] = std::clamp(u, ocp.system.control_lower[i], ocp.system.control_upper[i]);
    }
    system.initial_state = x;
    auto kept = kernels.take(system, evaluation::NativeCode::automatic);
    if (!kept) return tl::unexpected(kept.error());
    Integration run = event_integrator::integrate(
        kept->kernel, system, resimulation_options(path.times[k], path.times[k + 1], rows_of_interval), observer);
    kernels.give_back(std::move(*kept));
    auto& rows = whole.run.trajectory;
    for (std::size_t i = 0; i < run.trajectory.t.size(); ++i) {
      rows.t.push_back(run.trajectory.t[i]);
      rows.x.push_back(run.trajectory.x[i]);
    }
    x = run.final.x;
    // Modes of contacts are not in a result: the engine takes them from gaps and velocities.
    x.resize(system.state_names.size(), 0.0);
    whole.run.final = std::move(run.final);
    whole.run.status = std::move(run.status);
    const bool is_at_end = whole.run.status.time_reached >= path.times[k + 1] &&
                           std::all_of(x.begin(), x.end(), [](double value) { return std::isfinite(value); });
    if (!is_at_end || whole.run.status.termination == Termination::stopped_by_user) return whole;
  }
  whole.is_complete = true;
  return whole;
}

}  // namespace saltus::pipeline
