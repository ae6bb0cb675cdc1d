#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "saltus/base/at.hpp"
#include "saltus/linalg/matrix.hpp"
#include "saltus/model/ocp.hpp"
#include "saltus/model/time_freezing/time_freezing.hpp"
#include "saltus/pipeline/bodies/drawing.hpp"
#include "saltus/pipeline/optimal_control/advice_internal.hpp"
#include "saltus/pipeline/optimal_control/constraint_multipliers_internal.hpp"
#include "saltus/pipeline/optimal_control/optimum_result_internal.hpp"
#include "saltus/pipeline/options/number_list_internal.hpp"
#include "saltus/pipeline/options/optimize_fields.hpp"
#include "saltus/pipeline/simulate/simulation_internal.hpp"
#include "saltus/pipeline/time_freezing/physical_time_internal.hpp"

namespace saltus::pipeline {
namespace {

/// The model and its columns, without those that a problem or its frozen form has added.
result::Result begin_optimum(const model::Ocp& ocp, const std::vector<double>& parameters) {
  const auto& system = ocp.system;
  auto result = begin_result(system, "fesd");
  result.command = "optimize";
  result.controls.resize(at(ocp.user_controls));
  result.outputs.clear();
  for (const std::size_t column : shown_outputs(ocp)) result.outputs.push_back(system.output_names[column]);
  const auto is_made_by_freezing = [](const auto& group) { return group.name.find('.') != std::string::npos; };
  std::erase_if(result.region_groups, is_made_by_freezing);
  if (system.freezing) {
    result.states.resize(at(system.freezing->first_hidden));
    for (const auto& contact : system.freezing->contacts) result.contacts.push_back(contact.name);
  }
  const int stabilisation = system.freezing ? system.freezing->stabilisation : -1;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    if (static_cast<int>(i) == stabilisation || ocp.is_initial_value(i)) continue;  // not one of the model
    result.model.parameters.emplace_back(system.parameter_names[i], parameters[i]);
  }
  return result;
}

/// The point that the solver left, and its way there.
result::Optimization solved_point(const SolvedOcp& solved) {
  auto& problem = *solved.stated.problem;
  const auto& solution = solved.solution;
  result::Optimization found;
  found.objective = solution.objective;
  found.terms = problem.objective_terms(solution.w);
  found.homotopy = solution.homotopy;
  found.starts = solution.starts;
  found.certificate = solution.certificate;
  const auto& multipliers = solution.multipliers;
  found.multipliers = constraint_multipliers(problem, solution);
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
  statistics.build_seconds = solved.build_seconds;
  return found;
}

/// Adds the plan: what is free, the grid of its controls, its states, and their bounds.
void add_plan(const model::Ocp& ocp, const discretization::OcpSolution& plan, std::size_t states,
              result::Optimization& found) {
  const auto& system = ocp.system;
  found.state_lower.assign(system.state_lower.begin(), system.state_lower.begin() + index(states));
  found.state_upper.assign(system.state_upper.begin(), system.state_upper.begin() + index(states));
  const auto n = ocp.user_controls;
  found.control_lower.assign(system.control_lower.begin(), system.control_lower.begin() + n);
  found.control_upper.assign(system.control_upper.begin(), system.control_upper.begin() + n);
  found.horizon = plan.horizon;
  for (std::size_t i = 0; i < plan.parameters.size(); ++i) {
    if (ocp.free_parameters[i] && !ocp.is_initial_value(i))
      found.parameters.emplace_back(system.parameter_names[i], plan.parameters[i]);
  }
  const std::size_t intervals = plan.controls.size();
  for (std::size_t k = 0; k <= intervals; ++k) {
    found.grid.push_back(ocp.from + plan.horizon * static_cast<double>(k) / static_cast<double>(intervals));
  }
  found.nodes.push_back(plan.initial_state);
  for (std::size_t k = 0; k < intervals; ++k) {
    const auto& u = plan.controls[k];
    found.u.emplace_back(u.begin(), u.begin() + n);
    auto& lengths = found.h.emplace_back();
    for (const auto& element : plan.elements[k]) lengths.push_back(element.h);
    found.nodes.push_back(list_of(plan.elements[k].back().end));
  }
  if (system.freezing) {
    for (auto& node : found.nodes) node = shown_states(*system.freezing, node);
  }
  if (ocp.clock) found.speed_of_time = plan.speed_of_time;
}

}  // namespace

result::Result optimum_result(const model::Ocp& ocp, const OptimizeOptions& options, const SolvedOcp& solved,
                              const discretization::OcpSolution& read, OptimizedRun& run) {
  auto result = begin_optimum(ocp, read.parameters);
  result.options = option_record(options);
  result.trajectory = std::move(run.trajectory);
  for (std::size_t i = 0; i < result.states.size() && !result.trajectory.x.empty(); ++i) {
    result.model.initial_state.emplace_back(result.states[i], result.trajectory.x.front()[i]);
  }
  result.continuous = std::move(run.continuous);
  result.events = std::move(run.events);
  result.final = std::move(run.final);
  result.elements = std::move(run.elements);
  if (ocp.system.freezing) result.switching_functions = std::move(run.switching_functions);
  result.drawing = drawing_of(ocp.system, read.parameters, result.trajectory);
  auto& found = result.optimization.emplace(solved_point(solved));
  add_plan(ocp, read, result.states.size(), found);
  const auto termination = solved.solution.termination;
  result.status.termination = termination;
  result.status.message = solved.solution.message + advice_on_bounces(ocp.system.freezing.get(), options, termination);
  result.status.time_reached = found.grid.back();
  return result;
}

}  // namespace saltus::pipeline
