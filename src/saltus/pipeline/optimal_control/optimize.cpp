#include "saltus/pipeline/optimal_control/optimize.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "saltus/base/at.hpp"
#include "saltus/base/stopwatch.hpp"
#include "saltus/base/symbolic_lock.hpp"
#include "saltus/model/decisions.hpp"
#include "saltus/model/ocp.hpp"
#include "saltus/model/time_freezing/time_freezing.hpp"
#include "saltus/pipeline/bodies/drawing.hpp"
#include "saltus/pipeline/bodies/gaps.hpp"
#include "saltus/pipeline/element_choices_internal.hpp"
#include "saltus/pipeline/optimal_control/advice_internal.hpp"
#include "saltus/pipeline/optimal_control/optimized_run.hpp"
#include "saltus/pipeline/optimal_control/solve_ocp_internal.hpp"
#include "saltus/pipeline/optimal_control/verify.hpp"
#include "saltus/pipeline/options/number_list_internal.hpp"
#include "saltus/pipeline/options/optimize_fields.hpp"
#include "saltus/pipeline/time_freezing/physical_path_internal.hpp"
#include "saltus/pipeline/time_freezing/physical_time_internal.hpp"
#include "saltus/solver/feedback.hpp"

namespace saltus::pipeline {
namespace {

using result::Termination;

/// What does not depend on how the solution went.
result::Result result_frame(const model::Ocp& ocp, const OptimizeOptions& options) {
  const auto& system = ocp.system;
  result::Result result;
  result.command = "optimize";
  result.method = "fesd";
  result.model.name = system.name;
  result.model.description = system.description;
  result.states = system.state_names;
  if (system.freezing) result.states.resize(at(system.freezing->first_hidden));
  if (system.freezing) {
    for (const auto& contact : system.freezing->contacts) result.contacts.push_back(contact.name);
  }
  result.controls.assign(system.control_names.begin(), system.control_names.begin() + ocp.user_controls);
  for (const std::size_t column : shown_outputs(ocp)) result.outputs.push_back(system.output_names[column]);
  for (const auto& column : system.columns) result.switching_functions.push_back(column.name);
  for (const auto& group : system.mode_groups) {
    const bool is_shown = group.name.find('.') == std::string::npos;  // else freezing has made it
    if (group.first >= 0 && is_shown) result.region_groups.push_back({group.name, group.mode_names});
  }
  result.options = option_record(options);
  return result;
}

void take_bounds(const model::Ocp& ocp, result::Optimization& found) {
  const auto& system = ocp.system;
  found.state_lower = system.state_lower;
  found.state_upper = system.state_upper;
  if (system.freezing) {
    found.state_lower.resize(at(system.freezing->first_hidden));
    found.state_upper.resize(at(system.freezing->first_hidden));
  }
  const auto n = ocp.user_controls;
  found.control_lower.assign(system.control_lower.begin(), system.control_lower.begin() + n);
  found.control_upper.assign(system.control_upper.begin(), system.control_upper.begin() + n);
}

void take_solution(const model::Ocp& ocp, const discretization::OcpSolution& solution, result::Optimization& found) {
  found.horizon = solution.horizon;
  for (std::size_t i = 0; i < solution.parameters.size(); ++i) {
    if (ocp.free_parameters[i]) found.parameters.emplace_back(ocp.system.parameter_names[i], solution.parameters[i]);
  }
  const std::size_t intervals = solution.controls.size();
  for (std::size_t k = 0; k <= intervals; ++k) {
    found.grid.push_back(ocp.from + solution.horizon * static_cast<double>(k) / static_cast<double>(intervals));
  }
  found.nodes.push_back(solution.initial_state);
  for (std::size_t k = 0; k < intervals; ++k) {
    const auto& u = solution.controls[k];
    found.u.emplace_back(u.begin(), u.begin() + ocp.user_controls);
    auto& lengths = found.h.emplace_back();
    for (const auto& element : solution.elements[k]) lengths.push_back(element.h);
    found.nodes.push_back(list_of(solution.elements[k].back().end));
  }
  if (ocp.system.freezing) {
    for (auto& node : found.nodes) node = shown_states(ocp.system, node);
  }
  if (ocp.clock) found.speed_of_time = solution.speed_of_time;
}

/// The point that the solver left, in the quantities of the result.
void take_point(discretization::OcpProblem& problem, const solver::Solution& solution, result::Optimization& found) {
  found.objective = solution.objective;
  found.terms = problem.objective_terms(solution.w);
  found.homotopy = solution.homotopy;
  found.certificate = solution.certificate;
  const auto& multipliers = solution.multipliers;
  if (multipliers.rows.size() == problem.constraints()) {
    const Eigen::VectorXd bounds = multipliers.upper.size() == problem.variables()
                                       ? Eigen::VectorXd(multipliers.upper - multipliers.lower)
                                       : Eigen::VectorXd();
    found.multipliers = problem.constraint_multipliers(solution.w, multipliers.rows, bounds);
  }
  found.primal = list_of(solution.w);
  found.dual_rows = list_of(multipliers.rows);
  found.dual_lower = list_of(multipliers.lower);
  found.dual_upper = list_of(multipliers.upper);
  auto& statistics = found.statistics;
  statistics.iterations = solution.iterations;
  statistics.variables = problem.variables();
  statistics.equations = problem.constraints();
  statistics.pairs = problem.pairs();
  statistics.evaluation_seconds = solution.evaluation_seconds;
  statistics.linear_algebra_seconds = solution.solver_seconds;
}

/// States by the range that they have in the plan, controls by the width of their bounds; what does not move, or has
/// none, may be off by anything.
std::optional<solver::TrackingScales> tracking_scales(const model::Ocp& ocp, const OptimizeOptions& options,
                                                      const OptimizedPath& path) {
  if (options.feedback != Feedback::tracking) return std::nullopt;
  const auto widths = [](const std::vector<double>& low, const std::vector<double>& high) {
    std::vector<double> list;
    for (std::size_t i = 0; i < low.size(); ++i) list.push_back(high[i] > low[i] ? high[i] - low[i] : INFINITY);
    return list;
  };
  return solver::TrackingScales{widths(path.state_min, path.state_max),
                                widths(ocp.system.control_lower, ocp.system.control_upper)};
}

/// How deep bodies are in each other at the nodes and stages.
double solution_depth(const model::Ocp& ocp, const discretization::OcpSolution& solution) {
  Gaps gaps(*ocp.physical, solution.parameters);
  const auto clock = at(ocp.system.freezing->clock);
  const auto depth = [&](const std::vector<double>& x) { return gaps.depth(x[clock], x); };
  double deepest = depth(solution.initial_state);
  for (const auto& interval : solution.elements) {
    for (const auto& element : interval) {
      for (Eigen::Index m = 0; m < element.states.cols(); ++m) {
        deepest = std::max(deepest, depth(list_of(element.states.col(m))));
      }
      deepest = std::max(deepest, depth(list_of(element.end)));
    }
  }
  return deepest;
}

/// Frozen systems stand for others, which the event engine simulates.
Expected<result::Verification> judged_by_events(const model::Ocp& ocp, const OptimizedPath& path,
                                                const result::Result& run, const OptimizeOptions& options,
                                                std::vector<Eigen::MatrixXd> gains, PhysicalBodies* bodies,
                                                const OptimizeObservers& observers) {
  const VerificationWanted wanted{options.verification_tolerance, std::move(gains)};
  if (bodies == nullptr) return verify(ocp, path, wanted, observers.is_interrupted);
  return verify(physical_ocp(ocp), physical_path(ocp, *bodies, path, run), wanted, observers.is_interrupted);
}

/// Observers whose warnings the status of an optimum has, too: it says what the certificate leaves open.
OptimizeObservers noting(const OptimizeObservers& observers, result::Status& status) {
  auto noted = observers;
  noted.on_warning = [&observers, &status](const std::string& warning) {
    if (is_done(status.termination)) status.message += (status.message.empty() ? "" : "; ") + warning;
    observers.on_warning(warning);
  };
  return noted;
}

void take_parameters(const model::Ocp& ocp, const discretization::OcpSolution& read, result::Result& result) {
  const int stabilisation = ocp.system.freezing ? ocp.system.freezing->stabilisation : -1;
  for (std::size_t i = 0; i < read.parameters.size(); ++i) {
    if (static_cast<int>(i) == stabilisation) continue;  // not one of the model
    result.model.parameters.emplace_back(ocp.system.parameter_names[i], read.parameters[i]);
  }
}

/// All of it but its path.
void take_run(const model::Ocp& ocp, OptimizedRun& run, result::Result& result) {
  result.trajectory = std::move(run.trajectory);
  for (std::size_t i = 0; i < result.states.size() && !result.trajectory.x.empty(); ++i) {
    result.model.initial_state.emplace_back(result.states[i], result.trajectory.x.front()[i]);
  }
  result.continuous = std::move(run.continuous);
  result.events = std::move(run.events);
  result.final = std::move(run.final);
  result.elements = std::move(run.elements);
  if (ocp.system.freezing) result.switching_functions = std::move(run.switching_functions);
}

/// A result is started from with the elements that it has.
void keep_added_elements(const std::vector<int>& elements, const OptimizeObservers& observers,
                         OptimizeOptions& options) {
  options.elements.assign(elements.begin(), elements.end());
  observers.on_warning(fmt::format(
      "intervals have more elements than asked for, as another motion needs them and is better: elements = [{}]",
      fmt::join(elements, ", ")));
}

}  // namespace

Expected<result::Result> optimize(const model::Ocp& ocp, const OptimizeOptions& asked,
                                  const OptimizeObservers& observers) {
  const SymbolicLock lock;  // problems are made, and dropped, while it runs
  const Stopwatch whole;
  if (auto error = model::find_stale(ocp.system)) return tl::unexpected(*error);
  auto solved = solve_ocp(ocp, asked, observers);
  if (!solved) return tl::unexpected(solved.error());
  auto& problem = *solved->stated.problem;
  const auto& solution = solved->solution;
  OptimizeOptions options = asked;
  if (solved->has_more_elements) keep_added_elements(solved->stated.elements, observers, options);
  result::Result result = result_frame(ocp, options);
  auto& found = result.optimization.emplace();
  take_bounds(ocp, found);
  take_point(problem, solution, found);
  found.statistics.build_seconds = solved->build_seconds;
  result.status.termination = solution.termination;
  result.status.message = solution.message + advice_on_bounces(ocp, options, solution.termination);

  const auto read = problem.read(solution.w);
  take_solution(ocp, read, found);
  take_parameters(ocp, read, result);
  result.status.time_reached = found.grid.back();
  auto run = optimized_run(ocp, read, reformulation_options(options.element), solved->stated.tableau);
  if (!run) return tl::unexpected(run.error());
  take_run(ocp, *run, result);
  result.drawing = drawing_of(ocp.system, read.parameters, result.trajectory);
  std::unique_ptr<PhysicalBodies> bodies;
  if (ocp.physical) {
    auto made = PhysicalBodies::make(ocp, run->path.parameters);
    if (!made) return tl::unexpected(made.error());
    bodies = std::move(*made);
    add_impulses(*bodies, result);
  }
  const auto noted = noting(observers, result.status);
  warn_of_impacts_at_nodes(result, noted);
  warn_of_crowded_intervals(problem, solution, options, noted);
  if (result.status.termination != Termination::stopped_by_user && solution.w.allFinite()) {
    std::vector<Eigen::MatrixXd> gains;
    if (options.closed_loop.value_or(ocp.plant || !result.contacts.empty())) {
      gains = solver::feedback_gains(problem, solution, static_cast<int>(ocp.system.control_names.size()),
                                     static_cast<int>(result.states.size()), tracking_scales(ocp, options, run->path));
    }
    auto verification = judged_by_events(ocp, run->path, result, options, std::move(gains), bodies.get(), observers);
    if (!verification) return tl::unexpected(verification.error());
    judge(*verification, options, result.status);
    warn_of_path_violations(ocp, *verification, options, observers);
    if (verification->penetration) verification->penetration->solution = solution_depth(ocp, read);
    found.verification = std::move(*verification);
  }
  found.statistics.wall_seconds = whole.seconds();
  result.statistics.wall_seconds = found.statistics.wall_seconds;
  return result;
}

}  // namespace saltus::pipeline
