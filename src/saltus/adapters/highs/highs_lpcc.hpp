// Linear programs with complementarity constraints by HiGHS.
#pragma once

#include <memory>

#include "saltus/solver/lpcc_solver.hpp"

namespace saltus::adapters {

/// Does branch and bound over the disjunctions, depth first, on linear programs that begin from the basis of the one
/// before; no big M. Exact if it ends before its limits: at most 2^(k + 1) programs for k disjunctions, few where d = 0
/// is the solution. Prints nothing; the same problem gives the same bits unless time runs out.
class HighsLpcc final : public solver::LpccSolver {
 public:
  explicit HighsLpcc(int node_limit = 20000);
  ~HighsLpcc() override;

  [[nodiscard]] solver::LpccSolution solve(const solver::LpccProblem& problem, double seconds) override;
  [[nodiscard]] const char* name() const override { return "highs"; }

 private:
  int node_limit_;
};

}  // namespace saltus::adapters
