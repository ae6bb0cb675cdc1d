#include "saltus/fesd_integrator/step_problem.hpp"

#include <utility>

#include "saltus/base/at.hpp"
#include "saltus/solver/active_set/polish.hpp"
#include "saltus/solver/homotopy/follow_path.hpp"

namespace saltus::fesd_integrator {

using discretization::SolvedElement;
using result::Termination;

StepProblem::StepProblem(std::shared_ptr<discretization::FesdKernel> kernel, int elements, solver::NlpSolver& solver)
    : kernel_(std::move(kernel)),
      problem_(std::make_unique<discretization::FesdProblem>(kernel_, elements)),
      solver_(&solver) {}

Expected<StepProblem> StepProblem::make(const reformulation::Dcs& dcs, std::vector<double> parameters,
                                        const discretization::ButcherTableau& tableau,
                                        const discretization::FesdOptions& options, int elements,
                                        solver::NlpSolver& solver, evaluation::NativeCode native) {
  auto kernel = discretization::FesdKernel::compile(dcs, std::move(parameters), tableau, options, native);
  if (!kernel) return tl::unexpected(kernel.error());
  return StepProblem(std::move(*kernel), elements, solver);
}

/// Of every pair one sum over the element is zero: which one tells the mode (Lemmas 9 and 10 of [nurkanovic2024]).
std::vector<int> StepProblem::modes_of(const SolvedElement& element) const {
  const linalg::Vector lambda = element.lambda.row_sums();
  std::vector<int> modes(static_cast<std::size_t>(element.selections.rows()), 0);
  for (std::size_t k = 0; k < kernel_->pairs().size(); ++k) {
    const auto& pair = kernel_->pairs()[k];
    const double sum = element.selections.row(pair.selection).sum();
    const double a = pair.complement ? static_cast<double>(element.selections.cols()) - sum : sum;
    if (lambda[static_cast<linalg::Index>(k)] <= a) continue;
    modes[at(pair.selection)] = pair.complement ? 1 : -1;
  }
  return modes;
}

StepSolution StepProblem::solve(const discretization::StepData& step) {
  problem_->set_step(step);
  // Without multipliers from step to step: the same step gives the same bits whatever was solved before.
  auto path = solver::homotopy::follow_path(*problem_, problem_->first_guess(), *solver_, {});
  StepSolution solution;
  if (!path) {
    solution.message = path.error().message;
    return solution;
  }
  solution.iterations = path->iterations;
  solution.termination = path->termination;
  solution.message = path->message;
  if (path->termination != Termination::completed) return solution;
  if (solver::active_set::polish(*problem_, path->point.w) != solver::active_set::PolishOutcome::polished) {
    solution.termination = Termination::verification_failed;
    solution.message = "the solution of the homotopy could not be refined with its active set";
  }
  for (const auto& element : problem_->read(path->point.w)) {
    // Elements may vanish where there are more of them than the step needs.
    if (element.h < 1e-9 * step.length) continue;
    solution.elements.push_back(
        {element.t, element.h, modes_of(element), element.states, element.selections, element.end});
  }
  return solution;
}

}  // namespace saltus::fesd_integrator
