// The controls of an optimum with feedback, simulated event by event.
#include <algorithm>
#include <cmath>
#include <utility>

#include "saltus/base/at.hpp"
#include "saltus/model/ocp.hpp"
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
  system.input = system.input_at_instant = controls;
  system.p = casadi::SX::vertcat({system.p, controls});
  for (const auto& name : system.control_names) system.parameter_names.push_back("control." + name);
  system.parameter_values.resize(system.parameter_names.size(), 0.0);
  system.events.clear();  // they would stop it
  return system;
}

/// Rows of equal distance between two corrections.
constexpr std::size_t rows_between = 10;
/// Of the mean interval: elements that start so near to each other start at one time, as where time is frozen.
constexpr double one_time = 1e-6;

/// Holds a time at which the controls of an interval are corrected, and what the state there is compared with.
struct Correction {
  double t = 0.0;
  std::size_t interval = 0;
  const std::vector<double>*before = nullptr, *behind = nullptr;  ///< different where the plan jumps
  const linalg::Matrix* gain = nullptr;
};

std::vector<Correction> corrections_of(const OptimizedPath& path, const std::vector<linalg::Matrix>& gains) {
  std::vector<Correction> list;
  const double rounding =
      one_time * (path.times.back() - path.times.front()) / static_cast<double>(path.controls.size());
  for (std::size_t e = 0; e < path.elements.size(); ++e) {
    const auto& start = path.elements[e];
    if (list.empty() || start.t - list.back().t > rounding) {
      list.push_back({.t = start.t, .before = &start.x});
    }
    auto& last = list.back();
    last.interval = start.interval;
    last.behind = &start.x;
    if (gains[e].size() > 0) last.gain = &gains[e];
  }
  // What is corrected where the horizon ends would have no time to act.
  const double end = path.times.back() - rounding;
  std::erase_if(list, [end](const Correction& one) { return one.gain == nullptr || one.t >= end; });
  return list;
}

/// The state of the plan that a state is compared with: where the plan jumps, the nearer one. A body that lands a
/// little later than planned is off by nothing, and not by the velocity that the collision takes.
const std::vector<double>& planned_state(const OptimizedPath& path, const Correction& one,
                                         const std::vector<double>& x) {
  const auto distance = [&](const std::vector<double>& planned) {
    double square = 0.0;
    for (std::size_t i = 0; i < planned.size(); ++i) {
      const double range = path.state_max[i] - path.state_min[i];
      if (range > 0.0) square += std::pow((x[i] - planned[i]) / range, 2);
    }
    return square;
  };
  return distance(*one.before) < distance(*one.behind) ? *one.before : *one.behind;
}

/// The controls of its interval, moved onto their bounds.
std::vector<double> corrected_controls(const model::Ocp& ocp, const OptimizedPath& path, const Correction& one,
                                       const std::vector<double>& x) {
  const auto& planned = planned_state(path, one, x);
  linalg::Vector off(one.gain->cols());
  for (linalg::Index i = 0; i < off.size(); ++i) off[i] = x[at(i)] - planned[at(i)];
  const linalg::Vector change = *one.gain * off;
  std::vector<double> controls = path.controls[one.interval];
  for (std::size_t i = 0; i < controls.size(); ++i) {
    controls[i] = std::clamp(controls[i] + change[index(i)], ocp.system.control_lower[i], ocp.system.control_upper[i]);
  }
  return controls;
}

}  // namespace

std::vector<result::FeedbackGain> used_gains(const OptimizedPath& path, const std::vector<linalg::Matrix>& gains) {
  std::vector<result::FeedbackGain> list;
  for (const auto& one : corrections_of(path, gains)) {
    auto& gain = list.emplace_back(result::FeedbackGain{one.t, static_cast<int>(one.interval), {}});
    for (linalg::Index i = 0; i < one.gain->rows(); ++i) {
      auto& row = gain.K.emplace_back();
      for (linalg::Index k = 0; k < one.gain->cols(); ++k) row.push_back((*one.gain)(i, k));
    }
  }
  return list;
}

Expected<Resimulation::Segment> simulate_closed_loop(const model::Ocp& ocp, const OptimizedPath& path,
                                                     const std::vector<linalg::Matrix>& gains,
                                                     const std::function<bool()>& is_interrupted) {
  model::System system = with_parameters_as_controls(optimised_plant(ocp, path), path);
  const auto first = index(path.parameters.size());
  const auto observer = [&](const result::Progress&) {
    return is_interrupted && is_interrupted() ? result::Continue::no : result::Continue::yes;
  };
  KernelStore kernels;
  Resimulation::Segment whole;
  std::vector<double> x = system.initial_state;
  const auto corrections = corrections_of(path, gains);
  for (std::size_t j = 0; j < corrections.size(); ++j) {
    const auto& one = corrections[j];
    const double until = j + 1 < corrections.size() ? corrections[j + 1].t : path.times.back();
    const auto controls = corrected_controls(ocp, path, one, x);
    std::copy(controls.begin(), controls.end(), system.parameter_values.begin() + first);
    system.initial_state = x;
    auto kept = kernels.take(system, evaluation::NativeCode::automatic);
    if (!kept) return tl::unexpected(kept.error());
    Integration run =
        event_integrator::integrate(kept->kernel, resimulation_options(one.t, until, rows_between), observer);
    kernels.give_back(std::move(*kept));
    auto& rows = whole.run.trajectory;
    for (std::size_t i = 0; i < run.trajectory.t.size(); ++i) {
      rows.t.push_back(run.trajectory.t[i]);
      rows.x.push_back(run.trajectory.x[i]);
    }
    x = run.final.x;
    whole.run.final = std::move(run.final);
    whole.run.status = std::move(run.status);
    const bool is_at_end = whole.run.status.time_reached >= until &&
                           std::all_of(x.begin(), x.end(), [](double value) { return std::isfinite(value); });
    if (!is_at_end || whole.run.status.termination == Termination::stopped_by_user) return whole;
  }
  whole.is_complete = true;
  return whole;
}

}  // namespace saltus::pipeline
