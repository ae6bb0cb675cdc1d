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
};

/// Solves the problem. Where a motion needs an element more than an interval has, the interval gets it, and the
/// solution goes on from the same point; what is better stays.
[[nodiscard]] Expected<SolvedOcp> solve_ocp(const model::Ocp& ocp, const OptimizeOptions& options,
                                            const OptimizeObservers& observers);

}  // namespace saltus::pipeline
