// Multipliers of what the user asks of a solution, and how far they are determined.
#pragma once

#include <vector>

#include "saltus/discretization/ocp/ocp_problem.hpp"
#include "saltus/result/optimization.hpp"
#include "saltus/solver/solve.hpp"

namespace saltus::pipeline {

/// Returns those of terminal, path and boundary constraints, and of bounds of states that press. One that is not unique
/// has a range instead of a value. Empty where the solver left none. Cost: two small linear programs for each of those.
[[nodiscard]] std::vector<result::ConstraintMultiplier> constraint_multipliers(
    const discretization::OcpProblem& problem, const solver::Solution& solution);

}  // namespace saltus::pipeline
