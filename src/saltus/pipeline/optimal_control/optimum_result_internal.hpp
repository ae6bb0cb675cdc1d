// The result of an optimisation, put together.
#pragma once

#include "saltus/discretization/ocp/ocp_problem.hpp"
#include "saltus/pipeline/optimal_control/optimized_run.hpp"
#include "saltus/pipeline/optimal_control/solve_ocp_internal.hpp"
#include "saltus/pipeline/options/optimize_options.hpp"
#include "saltus/result/result.hpp"

namespace saltus::model {
struct Ocp;
}

namespace saltus::pipeline {

/// Returns all of it but what a simulation says of the point.
/// @param read  the point of `solved` as states, controls and elements
/// @param run   all of which goes into the result, but its path
[[nodiscard]] result::Result optimum_result(const model::Ocp& ocp, const OptimizeOptions& options,
                                            const SolvedOcp& solved, const discretization::OcpSolution& read,
                                            OptimizedRun& run);

}  // namespace saltus::pipeline
