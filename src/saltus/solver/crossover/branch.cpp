#include "saltus/solver/crossover/branch.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "saltus/solver/certificate/classify.hpp"
#include "saltus/solver/crossover/refine.hpp"

namespace saltus::solver::crossover {
namespace {

using result::Termination;

/// An error above says that the solver has not found a solution, rather than not all of its digits.
constexpr double unsolved = 1e-6;
/// Violations of a branch that has a solution.
constexpr double solved = 1e-9;

/// Whether the solver has seen that this branch is of no use: it needs no more digits and no second attempt.
bool is_useless(const Branch& branch, const NlpOptions& options) {
  if (!options.objective_cutoff) return false;
  const double largest = *options.objective_cutoff + 1e-6 * std::max(1.0, std::abs(*options.objective_cutoff));
  const auto why = branch.report.termination;
  return (why == Termination::completed || why == Termination::not_converged) && branch.report.objective > largest;
}

/// Solves from `start`, then refines; without free variables there is nothing to solve.
void solve_from(const linalg::Vector& start, Branch& branch, NlpSolver& nlp, const NlpOptions& options) {
  BranchProblem& reduced = *branch.problem;
  branch.point = {.w = start, .y = {}, .z_lower = {}, .z_upper = {}};
  const int iterations = branch.report.iterations;
  const double evaluation_seconds = branch.report.evaluation_seconds;
  branch.report = {};
  branch.report.termination = Termination::completed;
  if (reduced.variables() > 0) branch.report = nlp.solve(reduced, branch.point, options);
  branch.report.iterations += iterations;
  branch.report.evaluation_seconds += evaluation_seconds;
  NlpPoint& point = branch.point;
  const bool is_whole = point.w.all_finite() && point.y.size() == reduced.constraints() && point.y.all_finite() &&
                        point.z_lower.size() == reduced.variables() && point.z_upper.size() == reduced.variables();
  if (!is_whole) {
    point = {.w = start,
             .y = linalg::Vector::zero(reduced.constraints()),
             .z_lower = linalg::Vector::zero(reduced.variables()),
             .z_upper = linalg::Vector::zero(reduced.variables())};
  }
  branch.optimality_error =
      is_useless(branch, options) ? std::numeric_limits<double>::infinity() : refine(reduced, point);
}

/// Leaves out equations that depend on others at v; false if there are none.
bool drop_dependent(BranchProblem& reduced, const linalg::Vector& v) {
  const std::vector<int> dependent = dependent_equations(reduced, v);
  if (!dependent.empty()) reduced.drop_rows(dependent);
  return !dependent.empty();
}

bool has_failed(const Branch& branch, const NlpOptions& options) {
  if (is_useless(branch, options)) return false;
  const auto why = branch.report.termination;
  const bool by_itself = why == Termination::infeasible || why == Termination::not_converged ||
                         why == Termination::factorization_failed || why == Termination::step_size_too_small;
  return by_itself && !(branch.optimality_error <= unsolved);
}

Branch solve_closed(mpcc::Problem& problem, const std::vector<mpcc::ActiveSide>& sides, ConstVectorView w,
                    NlpSolver& nlp, const NlpOptions& options, const std::vector<int>& kept, Closing closing) {
  Branch branch;
  branch.sides = sides;
  linalg::Vector c(problem.rows());
  problem.functions(w, c);
  branch.problem =
      std::make_unique<BranchProblem>(problem, reduce(problem, sides, jacobian_matrix(problem, w), c, closing));
  BranchProblem& reduced = *branch.problem;
  reduced.keep_above(kept, w);
  const linalg::Vector start = reduced.reduced(w);
  if (reduced.reduction().equations() > reduced.variables()) drop_dependent(reduced, start);
  solve_from(start, branch, nlp, options);
  // Equations that depend on each other at the solution are no reason to fail, but can be one to find no direction.
  if (has_failed(branch, options) && drop_dependent(reduced, branch.point.w)) solve_from(start, branch, nlp, options);
  branch.w = reduced.full(branch.point.w);
  problem.complete(branch.w);
  branch.objective = problem.objective(branch.w);
  branch.primal_infeasibility = certificate::scaled_infeasibility(problem, branch.w);
  branch.complementarity_residual = certificate::complementarity(problem, branch.w);
  return branch;
}

}  // namespace

Branch solve_branch(mpcc::Problem& problem, const std::vector<mpcc::ActiveSide>& sides, ConstVectorView w,
                    NlpSolver& nlp, const NlpOptions& options, const std::vector<int>& kept) {
  Branch closed = solve_closed(problem, sides, w, nlp, options, kept, Closing::whole);
  const bool is_optimal = closed.optimality_error <= unsolved || closed.report.termination == Termination::completed;
  const bool is_decided = is_useless(closed, options) || (closed.primal_infeasibility <= solved && is_optimal);
  if (is_decided || problem.close_branch(sides).freedom.is_empty()) return closed;
  // A closed branch may have no solution where its elements are too coarse.
  NlpOptions rest = options;
  rest.iteration_limit -= closed.report.iterations;
  if (rest.iteration_limit <= 0) return closed;
  Branch open = solve_closed(problem, sides, w, nlp, rest, kept, Closing::with_freedom);
  open.report.iterations += closed.report.iterations;
  open.report.evaluation_seconds += closed.report.evaluation_seconds;
  return open;
}

}  // namespace saltus::solver::crossover
