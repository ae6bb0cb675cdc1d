#include <algorithm>
#include <cmath>

#include "saltus/solver/certificate/classify.hpp"
#include "saltus/solver/crossover/sides.hpp"
#include "saltus/solver/run_internal.hpp"

namespace saltus::solver {

using result::Termination;

namespace {

/// Of one linear program with complementarities.
constexpr double lpcc_seconds = 60.0;
/// Of the solver's scaled error; what is missing to rounding, refine.hpp adds.
constexpr double problem_tolerance = 1e-10;

}  // namespace

/// A limit of the whole holds for its linear programs, too.
double seconds_of_lpcc(const Run& run) {
  const double left = run.options.time_limit ? *run.options.time_limit - run.seconds() : lpcc_seconds;
  return std::clamp(left, 0.0, lpcc_seconds);
}

Run::Run(mpcc::Problem& problem_to_solve, NlpSolver& nlp_solver, LpccSolver& lpcc_solver, const SolveOptions& wanted)
    : problem(problem_to_solve),
      nlp(nlp_solver),
      lpcc(lpcc_solver),
      options(wanted),
      schedule(wanted.schedule),
      iteration_limit(wanted.iteration_limit),
      groups(crossover::groups_of(problem_to_solve)) {
  schedule.sigma_initial = wanted.sigma_initial.value_or(schedule.sigma_initial);
}

bool Run::is_over() {
  if (stopped) return true;
  if (options.is_interrupted && options.is_interrupted()) {
    stopped = Termination::stopped_by_user;
  } else if (options.time_limit && seconds() >= *options.time_limit) {
    stopped = Termination::time_limit;
  } else if (solution.iterations >= iteration_limit) {
    stopped = Termination::iteration_limit;
  }
  return stopped.has_value();
}

NlpOptions Run::nlp_options(int most_iterations) const {
  NlpOptions result;
  result.tolerance = problem_tolerance;
  result.iteration_limit = std::max(0, std::min(most_iterations, iteration_limit - solution.iterations));
  if (options.time_limit) result.time_limit = std::max(0.0, *options.time_limit - seconds());
  result.is_interrupted = options.is_interrupted;
  return result;
}

void Run::record(result::HomotopyStep step, const NlpReport* report, double started) {
  step.seconds = seconds() - started;
  if (report != nullptr) {
    step.solver = nlp.name();
    step.iterations = report->iterations;
    step.termination = report->termination;
    if (step.message.empty()) step.message = report->message;
    solution.iterations += report->iterations;
    solution.evaluation_seconds += report->evaluation_seconds;
  }
  solution.solver_seconds += step.seconds - (report != nullptr ? report->evaluation_seconds : 0.0);
  solution.homotopy.push_back(step);
  if (options.on_step) options.on_step(solution.homotopy.back());
}

void Run::add(const Solution& done) {
  solution.iterations += done.iterations;
  solution.evaluation_seconds += done.evaluation_seconds;
  solution.solver_seconds += done.solver_seconds;
  for (const auto& step : done.homotopy) {
    solution.homotopy.push_back(step);
    if (options.on_step) options.on_step(step);
  }
}

crossover::Branch Run::solve_branch(const std::vector<mpcc::ActiveSide>& sides, ConstVectorView w, int most_iterations,
                                    std::string message, std::optional<double> cutoff, const std::vector<int>& kept,
                                    std::optional<double> first_mu) {
  const double started = seconds();
  NlpOptions limited = nlp_options(most_iterations);
  limited.objective_cutoff = cutoff;
  limited.first_barrier_mu = first_mu;
  crossover::Branch found = crossover::solve_branch(problem, sides, w, nlp, limited, kept);
  result::HomotopyStep step;
  step.phase = result::HomotopyPhase::branch;
  step.sigma = relaxed.sigma;
  step.objective = found.objective;
  step.primal_infeasibility = found.primal_infeasibility;
  step.complementarity_residual = found.complementarity_residual;
  step.message = std::move(message);
  record(step, &found.report, started);
  return found;
}

}  // namespace saltus::solver
