// What a result of an optimisation lacks, and what to write for a better one.
#pragma once

#include <string>
#include <vector>

#include "saltus/discretization/ocp/ocp_problem.hpp"
#include "saltus/model/ocp_terms.hpp"
#include "saltus/pipeline/optimal_control/optimize.hpp"
#include "saltus/result/result.hpp"
#include "saltus/solver/solve.hpp"

namespace saltus::model {
struct TimeFreezing;
}

namespace saltus::pipeline {

/// Says what an unsolved problem with bounces lacks; empty where it has it.
/// @param freezing  of its system; null: none
[[nodiscard]] std::string advice_on_bounces(const model::TimeFreezing* freezing, const OptimizeOptions& options,
                                            result::Termination termination);

/// Takes `completed` back where the other engine does not agree.
void judge(const result::Verification& verification, const OptimizeOptions& options, result::Status& status);

/// Reports path constraints and bounds that the simulation violates by more of their range than states may be off.
/// @param path, points  constraints of the problem, and where it asks for them
void warn_of_path_violations(const std::vector<model::OcpConstraint>& path, model::ConstraintPoints points,
                             const result::Verification& verification, const OptimizeOptions& options,
                             const OptimizeObservers& observers);

/// Reports impacts that lie where control intervals end.
void warn_of_impacts_at_nodes(const result::Result& run, const OptimizeObservers& observers);

/// Reports intervals whose number of elements holds the objective up.
void warn_of_crowded_intervals(const discretization::OcpProblem& problem, const solver::Solution& solution,
                               const OptimizeOptions& options, const OptimizeObservers& observers);

}  // namespace saltus::pipeline
