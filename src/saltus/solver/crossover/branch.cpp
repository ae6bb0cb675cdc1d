#include "saltus/solver/crossover/branch.hpp"

#include "saltus/solver/certificate/classify.hpp"
#include "saltus/solver/crossover/refine.hpp"

namespace saltus::solver::crossover {
namespace {

using result::Termination;

/// A point without free variables has nothing to solve.
NlpReport evaluate_only(NlpPoint& point, const BranchProblem& problem) {
  point.y = Eigen::VectorXd::Zero(problem.constraints());
  point.z_lower = point.z_upper = Eigen::VectorXd(0);
  NlpReport report;
  report.termination = Termination::completed;
  return report;
}

}  // namespace

Branch solve_branch(mpcc::Problem& problem, const std::vector<mpcc::ActiveSide>& sides, ConstVectorView w, NlpSolver& nlp,
                    const NlpOptions& options) {
  Branch branch;
  branch.sides = sides;
  Eigen::VectorXd c(problem.rows());
  problem.functions(w, c);
  branch.problem = std::make_unique<BranchProblem>(problem, reduce(problem, sides, jacobian_matrix(problem, w), c));
  BranchProblem& reduced = *branch.problem;
  branch.point.w = reduced.reduced(w);
  if (reduced.reduction().equations() > reduced.variables() && reduced.variables() > 0) {
    reduced.drop_rows(dependent_equations(reduced, branch.point.w));
  }
  if (reduced.variables() == 0) {
    branch.report = evaluate_only(branch.point, reduced);
  } else {
    const NlpPoint start = branch.point;
    branch.report = nlp.solve(reduced, branch.point, options);
    const bool is_whole = branch.point.w.allFinite() && branch.point.y.size() == reduced.constraints() &&
                          branch.point.y.allFinite() && branch.point.z_lower.size() == reduced.variables();
    if (is_whole) {
      branch.optimality_error = refine(reduced, branch.point);
    } else {
      branch.point = start;
      branch.point.y = Eigen::VectorXd::Zero(reduced.constraints());
      branch.point.z_lower = branch.point.z_upper = Eigen::VectorXd::Zero(reduced.variables());
      branch.optimality_error = optimality_error(reduced, branch.point);
    }
  }
  branch.w = reduced.full(branch.point.w);
  branch.objective = problem.objective(branch.w);
  branch.primal_infeasibility = certificate::scaled_infeasibility(problem, branch.w);
  branch.complementarity_residual = certificate::complementarity(problem, branch.w);
  return branch;
}

}  // namespace saltus::solver::crossover
