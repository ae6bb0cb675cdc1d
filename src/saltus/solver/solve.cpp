#include "saltus/solver/solve.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "saltus/base/contracts.hpp"
#include "saltus/solver/crossover/sides.hpp"
#include "saltus/solver/relaxed_path_internal.hpp"

namespace saltus::solver {
namespace {

using result::Termination;

/// Of the branch problem of a start, which may be far from its solution. In one go: the solver keeps its barrier.
constexpr int start_iterations = 3000;
/// Of that of a motion: 7 to 100 where it leads to a solution.
constexpr int motion_iterations = 500;
/// Of one that nobody asked for: where the solution is near, it is found sooner.
constexpr int near_iterations = 150;

tl::unexpected<Error> refuse(ErrorCode code, std::string message) {
  Error error;
  error.code = code;
  error.message = std::move(message);
  return tl::unexpected(std::move(error));
}

Expected<void> check_options(const SolveOptions& options) {
  const auto& [of_schedule, factor, last] = options.schedule;
  const double initial = options.sigma_initial.value_or(of_schedule);
  const auto code = ErrorCode::invalid_option;
  if (!(initial > 0.0 && std::isfinite(initial))) {
    return refuse(code, fmt::format("sigma_initial = {} is not > 0", initial));
  }
  if (!(factor > 0.0 && factor < 1.0)) return refuse(code, fmt::format("sigma_factor = {} is not in (0, 1)", factor));
  if (!(last > 0.0 && last <= initial)) {
    return refuse(code, fmt::format("sigma_final = {} is not in (0, sigma_initial = {}]", last, initial));
  }
  if (!(options.tolerance > 0.0)) return refuse(code, fmt::format("tolerance = {} is not > 0", options.tolerance));
  if (options.iteration_limit < 1) {
    return refuse(code, fmt::format("iteration_limit = {} is not >= 1", options.iteration_limit));
  }
  if (options.time_limit && !(*options.time_limit > 0.0)) {
    return refuse(code, fmt::format("time_limit = {} is not > 0", *options.time_limit));
  }
  return {};
}

Expected<void> check_start(mpcc::Problem& problem, ConstVectorView w) {
  const auto code = ErrorCode::invalid_model;
  for (linalg::Index i = 0; i < w.size(); ++i) {
    if (!std::isfinite(w[i])) {
      return refuse(code, fmt::format("the start of {} is {}", problem.name(static_cast<int>(i)), w[i]));
    }
  }
  if (const double f = problem.objective(w); !std::isfinite(f)) {
    return refuse(code, fmt::format("the objective is {} at the start", f));
  }
  linalg::Vector c(problem.rows());
  problem.functions(w, c);
  for (linalg::Index i = 0; i < c.size(); ++i) {
    if (!std::isfinite(c[i])) {
      return refuse(code, fmt::format("{} is {} at the start", problem.row_name(static_cast<int>(i)), c[i]));
    }
  }
  return {};
}

double infeasibility_of(mpcc::Problem& problem, const linalg::Vector& w) {
  return std::max(certificate::scaled_infeasibility(problem, w), certificate::complementarity(problem, w));
}

/// What the solution begins with. A start that has multipliers was solved; where each of its pairs has a zero side,
/// too, these sides are those of a solution, and few of them change with the problem. Whoever asks for relaxed
/// problems, by a first sigma or random starts, gets them.
FirstProblem first_problem(const Run& run, const std::optional<Start>& start) {
  const auto& options = run.options;
  if (options.first != FirstProblem::automatic) return options.first;
  const bool wants_relaxed =
      !options.crossover || options.sigma_initial.has_value() || options.compared_starts.value_or(0) > 0;
  const bool is_solved = start && start->multipliers.lower.size() == run.problem.variables() &&
                         certificate::complementarity(run.problem, start->w) <= options.tolerance;
  return is_solved && !wants_relaxed ? FirstProblem::branch : FirstProblem::relaxed;
}

/// The branch of the start's sides, if it has a solution. Where a limit ends it, its point is kept if it is more nearly
/// feasible than the start.
bool solve_first_branch(Run& run, const linalg::Vector& w) {
  linalg::Vector c(run.problem.rows());
  run.problem.functions(w, c);
  const auto sides = crossover::smaller_sides(run.problem, run.groups, c);
  const int most = run.options.first == FirstProblem::branch ? start_iterations : near_iterations;
  auto branch = run.solve_branch(sides, w, most, "sides of the start");
  const bool is_better = run.is_over() && std::max(branch.primal_infeasibility, branch.complementarity_residual) <
                                              infeasibility_of(run.problem, w);
  if (!is_better && !branch.is_feasible(run.options.tolerance)) return false;
  if (!std::isfinite(branch.objective)) return false;
  run.branch = std::move(branch);
  return true;
}

/// A start that was taken for a solution, and is none: the problem is another one, and its sides are kept for the case
/// that nothing else is found.
bool is_still_solution(Run& run) {
  if (remains(run)) return true;
  run.refused = std::move(run.branch);
  run.branch.reset();
  return false;
}

bool has_small_residuals(const result::Certificate& certificate, double tolerance) {
  return certificate.primal_infeasibility <= tolerance && certificate.complementarity_residual <= tolerance &&
         certificate.stationarity <= tolerance;
}

/// Why a point that no limit has stopped is no solution.
std::string reason(const Run& run) {
  const auto& of = run.solution.certificate;
  const double tolerance = run.options.tolerance;
  if (run.solution.is_unbounded) return "unbounded: the iterates grow without limit while the objective falls";
  if (!(of.primal_infeasibility <= tolerance && of.complementarity_residual <= tolerance)) {
    const std::string rows = certificate::worst_rows(run.problem, run.solution.w, tolerance);
    return fmt::format("not feasible: {}{}{}", rows, run.failure.empty() ? "" : "; ", run.failure);
  }
  if (!(of.stationarity <= tolerance)) {
    return fmt::format("not stationary: the gradient of the Lagrangian is {:.3g}", of.stationarity);
  }
  if (!of.b_stationary) return "not decided whether the point is B-stationary";
  return fmt::format("not B-stationary: a direction of descent has slope {:.3g}", of.lpcc_decrease.value_or(0.0));
}

void judge(Run& run) {
  Solution& solution = run.solution;
  const auto& of = solution.certificate;
  const double tolerance = run.options.tolerance;
  const bool is_feasible = of.primal_infeasibility <= tolerance && of.complementarity_residual <= tolerance;
  if (has_small_residuals(of, tolerance) && of.b_stationary.value_or(false)) {
    solution.termination = Termination::completed;
    solution.message.clear();
  } else if (run.stopped && run.stopped != Termination::not_converged) {
    solution.termination = *run.stopped;
    const double worst = std::max(of.primal_infeasibility, of.complementarity_residual);
    solution.message = fmt::format("stopped before it was solved; constraints are violated by {:.3g}", worst);
  } else if (run.is_infeasible && !is_feasible) {
    solution.termination = Termination::infeasible;
    solution.message = "locally infeasible: " + certificate::worst_rows(run.problem, solution.w, tolerance);
  } else {
    solution.termination = Termination::not_converged;
    solution.is_unbounded = run.is_diverging;
    solution.message = reason(run);
  }
}

/// With what is known of the branch, or of the last relaxed point.
Solution finished(Run& run) {
  Solution& solution = run.solution;
  if (run.branch) {
    appraise(run);
    solution.crossed_over = true;
    solution.w = run.branch->w;
    solution.sides = run.branch->sides;
  } else {
    certify_relaxed(run);
    solution.w = run.relaxed.point.w.head(run.problem.variables());
  }
  solution.objective = run.problem.objective(solution.w);
  judge(run);
  return std::move(solution);
}

}  // namespace

Expected<Solution> solve_from(mpcc::Problem& problem, NlpSolver& nlp, LpccSolver& lpcc, const SolveOptions& options,
                              const std::optional<Start>& start) {
  if (auto checked = check_options(options); !checked) return tl::unexpected(checked.error());
  Start from = start.value_or(Start{.w = problem.start(), .multipliers = {}});
  SALTUS_ASSERT(from.w.size() == problem.variables());
  const auto& bounds = problem.variable_bounds();
  from.w = from.w.at_least(bounds.lower).at_most(bounds.upper);
  problem.without_method_terms();
  if (auto checked = check_start(problem, from.w); !checked) return tl::unexpected(checked.error());

  Run run(problem, nlp, lpcc, options);
  run.relaxed.point.w = from.w;
  const FirstProblem first = first_problem(run, start);
  const bool has_branch = first == FirstProblem::branch  ? solve_first_branch(run, from.w)
                          : first == FirstProblem::modes ? solve_modes(run, from.w)
                                                         : false;
  const bool is_descended = has_branch && options.first == FirstProblem::automatic && is_still_solution(run);
  const bool is_on_branch = is_descended || (has_branch && options.first != FirstProblem::automatic);
  const auto others = start ? std::vector<mpcc::NamedStart>() : problem.other_starts();
  const PathEnd end = is_on_branch ? PathEnd::crossed_over : follow_paths(run, from, others);
  if (options.crossover && end != PathEnd::crossed_over && end != PathEnd::stopped) rescue(run);
  if (!run.branch) run.branch = std::move(run.refused);
  if (run.branch && !is_descended) descend(run);
  return finished(run);
}

Solution solve_motion(mpcc::Problem& problem, NlpSolver& nlp, LpccSolver& lpcc, const SolveOptions& options,
                      const mpcc::NamedStart& motion) {
  problem.without_method_terms();
  Run run(problem, nlp, lpcc, options);
  auto branch = run.solve_branch(motion.sides, motion.w, motion_iterations, "the motion of these controls");
  if (!branch.is_feasible(options.tolerance) || !std::isfinite(branch.objective)) {
    run.solution.w = std::move(branch.w);
    return std::move(run.solution);
  }
  run.branch = std::move(branch);
  descend(run);
  return finished(run);
}

}  // namespace saltus::solver
