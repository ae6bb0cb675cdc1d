// Ipopt as a solver of nonlinear programs.
#pragma once

#include <memory>

#include "saltus/solver/nlp_solver.hpp"

namespace saltus::adapters {

/// Solves by the interior-point method of [waechter2006] with the linear solver MUMPS, through Ipopt's own C++
/// interface. Keeps its application between solutions, whatever their outcome. Bounds are not relaxed; reads no option
/// file; prints nothing.
class IpoptSolver final : public solver::NlpSolver {
 public:
  IpoptSolver();
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
