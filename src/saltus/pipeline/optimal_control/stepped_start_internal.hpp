// Controls of a problem with contacts from its coarse form, by time stepping.
#pragma once

#include <optional>
#include <vector>

#include "saltus/discretization/ocp/ocp_problem.hpp"
#include "saltus/pipeline/optimal_control/optimize.hpp"
#include "saltus/solver/solve.hpp"

namespace saltus::model {
struct Ocp;
}

namespace saltus::pipeline {

struct SteppedStart {
  discretization::OcpGuessValues guess;
  double objective = 0.0;  ///< of the steps
};

/// Adds the path that led to a solution to a record, with its iterations and seconds.
void add_path(const solver::Solution& solution, solver::Solution& record);

/// Solves the problem by time stepping, and returns controls and states at fractions of the horizon; nothing where it
/// cannot be stated or solved so.
/// @param record  its relaxed problems are added to the path, iterations and seconds
[[nodiscard]] std::optional<SteppedStart> stepped_start(const model::Ocp& ocp, const OptimizeOptions& options,
                                                        solver::SolveOptions wanted,
                                                        const std::vector<double>& fractions, solver::Solution& record);

}  // namespace saltus::pipeline
