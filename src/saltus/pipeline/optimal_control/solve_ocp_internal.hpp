// An optimal control problem, stated and solved, with as many elements as its solution needs.
#pragma once

#include "saltus/base/error.hpp"
#include "saltus/pipeline/optimal_control/ocp_problem.hpp"
#include "saltus/pipeline/optimal_control/optimize.hpp"
#include "saltus/solver/solve.hpp"

namespace saltus::model {
struct Ocp;
}

namespace saltus::pipeline {

struct SolvedOcp {
  StatedProblem stated;
  solver::Solution solution;
  bool has_more_elements = false;  ///< than were asked for
  double build_seconds = 0.0;
  double distance = 0.0;  ///< by which it is kept off what it would only touch
};

/// Solves the problem. Where a motion needs an element more than an interval has, the interval gets it, and the
/// solution goes on from the same point; what is better stays.
[[nodiscard]] Expected<SolvedOcp> solve_ocp(const model::Ocp& ocp, const OptimizeOptions& options,
                                            const OptimizeObservers& observers);

/// Solves again with surfaces kept off that the solution only touches, from its own branch. False where it touches
/// none, or that leads to no solution: then the solution is as before.
/// @param missed_in  the interval in which the motion itself switches
[[nodiscard]] bool keep_off_touched(const OptimizeOptions& options, const OptimizeObservers& observers, int missed_in,
                                    SolvedOcp& solved);

}  // namespace saltus::pipeline
