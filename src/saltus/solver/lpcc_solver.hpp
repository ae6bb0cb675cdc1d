// The seam to solvers of linear programs with complementarity constraints.
#pragma once

#include <utility>
#include <vector>

#include "saltus/linalg/matrix.hpp"
#include "saltus/mpcc/problem.hpp"
#include "saltus/result/status.hpp"

namespace saltus::solver {

/// States a linear problem with disjunctions, min cost'd   subject to   lower_row <= A d <= upper_row,   lower <= d <=
/// upper.
///   min cost'd   subject to   lower_row <= A d <= upper_row,   lower <= d <= upper.
/// A trust region is among the bounds, so they are finite. Of each disjunction (rows i, j) row i or row j of A d is at
/// its lower bound.
struct LpccProblem {
  linalg::Vector cost;
  mpcc::Pattern pattern;  ///< of A
  linalg::Vector entries;
  mpcc::Bounds rows;
  mpcc::Bounds variables;
  std::vector<std::pair<int, int>> disjunctions;
};

struct LpccSolution {
  /// completed, infeasible, time_limit, not_converged.
  result::Termination termination = result::Termination::not_converged;
  linalg::Vector d;
  double objective = 0.0;
  std::vector<bool> first_is_active;  ///< per disjunction: row i is at its lower bound
  int nodes = 0;                      ///< linear programs solved
};

class LpccSolver {
 public:
  LpccSolver() = default;
  virtual ~LpccSolver() = default;
  LpccSolver(const LpccSolver&) = delete;
  LpccSolver& operator=(const LpccSolver&) = delete;

  /// @param seconds  time limit
  [[nodiscard]] virtual LpccSolution solve(const LpccProblem& problem, double seconds) = 0;
  [[nodiscard]] virtual const char* name() const = 0;
};

}  // namespace saltus::solver
