// Multipliers of the problem with complementarities from those of branch and relaxed problems.
#pragma once

#include <vector>

#include "saltus/solver/crossover/branch_problem.hpp"
#include "saltus/solver/homotopy/relaxed_problem.hpp"
#include "saltus/solver/multipliers.hpp"
#include "saltus/solver/nlp_solver.hpp"

namespace saltus::solver::certificate {

/// Holds what is known of each pair at a point.
struct PairStates {
  std::vector<mpcc::ActiveSide> sides;  ///< the zero side: G or H
  std::vector<bool> biactive;           ///< the other one is zero, too
  std::vector<bool> is_open;            ///< and neither has to be zero because of other pairs of its group
};

/// Finds those at a solution of a branch problem. Implied sides get the multipliers of the bounds that they consist of:
/// what no bound can have, since it is negative, and as much as leaves those of the bounds >= 0; pairs that have no
/// choice first.
[[nodiscard]] MpccMultipliers multipliers_of_branch(mpcc::Problem& problem, const crossover::BranchProblem& branch,
                                                    const NlpPoint& point, const PairStates& states);

/// Finds those at a solution of a relaxed problem: of Scholtes' nu_G = z_G - xi H, nu_H = z_H - xi G.
[[nodiscard]] MpccMultipliers multipliers_of_relaxed(mpcc::Problem& problem, homotopy::RelaxedProblem& relaxed,
                                                     const NlpPoint& point, const PairStates& states);

/// Returns the max-norm of the gradient of the Lagrangian over max(1, mean |multiplier|). Of a branch problem: in its
/// variables.
[[nodiscard]] double stationarity(mpcc::Problem& problem, ConstVectorView w, const MpccMultipliers& multipliers,
                                  const crossover::Reduction* reduction);

}  // namespace saltus::solver::certificate
