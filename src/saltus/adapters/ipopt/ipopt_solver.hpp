// Ipopt as a solver of nonlinear programs.
#pragma once

#include <memory>

#include "saltus/solver/nlp_solver.hpp"
#include "saltus/solver/strategy.hpp"

namespace saltus::adapters {

/// Says what factorises the systems of linear equations.
enum class LinearSolver {
  mumps,      ///< of the wheel: orders and pivots of its own
  block_ldl,  ///< linalg::BlockLdl, in the order of mpcc::Problem::elimination_blocks
};

/// Returns what a strategy is solved with: the structured one with factors of our own.
[[nodiscard]] inline LinearSolver linear_solver_of(solver::Strategy strategy) {
  return strategy == solver::Strategy::structured ? LinearSolver::block_ldl : LinearSolver::mumps;
}

/// Solves by the interior-point method of [waechter2006], through Ipopt's own C++ interface. Keeps its application
/// between solutions, whatever their outcome. Bounds are not relaxed; reads no option file; prints nothing.
class IpoptSolver final : public solver::NlpSolver {
 public:
  explicit IpoptSolver(LinearSolver linear_solver = LinearSolver::mumps);
  ~IpoptSolver() override;

  [[nodiscard]] solver::NlpReport solve(mpcc::Problem& nlp, solver::NlpPoint& point,
                                        const solver::NlpOptions& options) override;
  [[nodiscard]] solver::NlpReport follow(mpcc::Problem& nlp, solver::NlpPoint& point, const solver::NlpOptions& options,
                                         double first, int longest, const solver::AskNextBarrier& next) override;
  [[nodiscard]] const char* name() const override { return "ipopt"; }

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace saltus::adapters
