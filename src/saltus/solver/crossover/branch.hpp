// A branch problem, solved.
#pragma once

#include <memory>
#include <vector>

#include "saltus/solver/crossover/branch_problem.hpp"
#include "saltus/solver/nlp_solver.hpp"

namespace saltus::solver::crossover {

struct Branch {
  std::vector<mpcc::ActiveSide> sides;  ///< G or H, one per pair
  std::unique_ptr<BranchProblem> problem;
  NlpPoint point;  ///< in the variables of the branch problem
  NlpReport report;
  linalg::Vector w;
  double objective = 0.0;  ///< NaN where it is not finite
  double primal_infeasibility = 0.0;
  double complementarity_residual = 0.0;
  double optimality_error = 0.0;  ///< of the branch problem

  [[nodiscard]] bool is_feasible(double tolerance) const {
    return primal_infeasibility <= tolerance && complementarity_residual <= tolerance;
  }
};

/// Solves the branch problem of these sides from w, then refines its solution (refine.hpp). Equations that are more
/// than the variables are left out where they depend on others; whether they hold is seen in the residuals. All
/// attempts together take no more than the limits of `options`.
/// @param kept  variables that stay above a part of what they are in w
[[nodiscard]] Branch solve_branch(mpcc::Problem& problem, const std::vector<mpcc::ActiveSide>& sides, ConstVectorView w,
                                  NlpSolver& nlp, const NlpOptions& options, const std::vector<int>& kept = {});

}  // namespace saltus::solver::crossover
