// A simulation step as a problem with complementarities: active sets and lengths of elements without predicting any.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "saltus/base/error.hpp"
#include "saltus/discretization/fesd_problem.hpp"
#include "saltus/result/status.hpp"
#include "saltus/solver/nlp_solver.hpp"

namespace saltus::reformulation {
struct Dcs;
}

namespace saltus::fesd_integrator {

/// Says what the problem says of one element.
struct ElementGuess {
  double t = 0.0;
  double h = 0.0;
  std::vector<int> modes;     ///< as in ActiveSet: per step selection -1, 0 (slides), 1; per region 0 (active) or -1
  linalg::Matrix states;      ///< n_x by n_s
  linalg::Matrix selections;  ///< n_selections by n_s
  linalg::Vector end;
};

struct StepSolution {
  /// completed: all equations hold to 1e-11; verification_failed: only to the accuracy of the homotopy, about 1e-9;
  /// else why there is no solution.
  result::Termination termination = result::Termination::not_converged;
  std::string message;
  std::vector<ElementGuess> elements;  ///< from the left; those that vanished (h < 1e-9 T) are left out
  int iterations = 0;                  ///< of the solver
};

/// Solves problem (47) of [nurkanovic2024] for one simulation step at a time: homotopy with Scholtes' relaxation over
/// the given solver from a start that knows nothing, then Newton's method with the active sides fixed. Cost: hundreds
/// of iterations of the solver, a thousand times that of an element whose active set is known.
class StepProblem {
 public:
  /// The solver must outlive it. Fails as FesdKernel::compile does.
  [[nodiscard]] static Expected<StepProblem> make(const reformulation::Dcs& dcs, std::vector<double> parameters,
                                                  const discretization::ButcherTableau& tableau,
                                                  const discretization::FesdOptions& options, int elements,
                                                  solver::NlpSolver& solver,
                                                  evaluation::NativeCode native = evaluation::NativeCode::off);
  [[nodiscard]] StepSolution solve(const discretization::StepData& step);

 private:
  StepProblem(std::shared_ptr<discretization::FesdKernel> kernel, int elements, solver::NlpSolver& solver);
  [[nodiscard]] std::vector<int> modes_of(const discretization::SolvedElement& element) const;

  std::shared_ptr<discretization::FesdKernel> kernel_;
  std::unique_ptr<discretization::FesdProblem> problem_;
  solver::NlpSolver* solver_;
};

}  // namespace saltus::fesd_integrator
