// What the parts of one solution share: limits, log, and the branch that has been found.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "saltus/base/stopwatch.hpp"
#include "saltus/solver/certificate/classify.hpp"
#include "saltus/solver/crossover/branch.hpp"
#include "saltus/solver/solve.hpp"

namespace saltus::solver {

/// Says where the relaxed problems have come to.
struct RelaxedState {
  std::unique_ptr<homotopy::RelaxedProblem> problem;
  NlpPoint point;  ///< in its variables, multipliers included
  NlpReport report;
  double sigma = 0.0;
};

class Run {
 public:
  Run(mpcc::Problem& problem_to_solve, NlpSolver& nlp_solver, LpccSolver& lpcc_solver, const SolveOptions& wanted);

  [[nodiscard]] double seconds() const { return stopwatch_.seconds(); }
  /// Returns whether a limit has been reached or the user wants an end; `stopped` says which.
  [[nodiscard]] bool is_over();
  /// Returns the limits of the next problem. A relaxed one that needs more iterations is better off with another sigma.
  [[nodiscard]] NlpOptions nlp_options(int most_iterations = 500) const;
  void record(result::HomotopyStep step, const NlpReport* report, double started);
  /// Adds what another run has done.
  void add(const Solution& done);
  /// Seconds of a problem that is recorded in parts.
  void count_evaluation(double seconds) {
    solution.evaluation_seconds += seconds;
    solution.solver_seconds -= seconds;
  }
  /// Solves a branch problem, counts and records it. It may be given up where its objective is above `cutoff`.
  [[nodiscard]] crossover::Branch solve_branch(const std::vector<mpcc::ActiveSide>& sides, ConstVectorView w,
                                               int most_iterations, std::string message = {},
                                               std::optional<double> cutoff = std::nullopt,
                                               const std::vector<int>& kept = {},
                                               std::optional<double> first_mu = std::nullopt);

  mpcc::Problem& problem;
  NlpSolver& nlp;
  LpccSolver& lpcc;
  const SolveOptions& options;
  homotopy::Schedule schedule;
  int iteration_limit;  ///< that of the options, and what starts that are compared have needed
  std::vector<std::vector<int>> groups;
  Solution solution;
  RelaxedState relaxed;                      ///< the last relaxed problem that left a point
  std::optional<crossover::Branch> branch;   ///< the best one accepted
  std::optional<crossover::Branch> refused;  ///< feasible, but its objective was too far above the relaxed one
  std::optional<double> best_before;         ///< objective of the best branch that paths before have led to
  std::map<std::vector<mpcc::ActiveSide>, double> known;  ///< objectives of feasible branches of relaxed points
  std::optional<result::Termination> stopped;             ///< not_converged: the objective falls without end
  std::string failure;                                    ///< why the last relaxed problem failed
  bool is_diverging = false;                              ///< it failed since its iterates grow without bounds
  bool is_infeasible = false;                             ///< a relaxed problem was infeasible

 private:
  Stopwatch stopwatch_;
};

/// Returns the time limit of one linear program with complementarities.
[[nodiscard]] double seconds_of_lpcc(const Run& run);
/// Returns whether a ray from a point is feasible as far as numbers go, and the objective falls along it. Then the
/// problem has no solution. Cost: one linear program.
[[nodiscard]] bool falls_without_end(Run& run, const linalg::Vector& w);
/// Solves from one start, whatever SolveOptions::starts.
[[nodiscard]] Expected<Solution> solve_from(mpcc::Problem& problem, NlpSolver& nlp, LpccSolver& lpcc,
                                            const SolveOptions& options, const std::optional<Start>& start);

/// Solves the branch of the start's sides, or of others: what is paid for its zero sides where their price is large
/// says which are changed. Leaves it in run.branch; false if there is none.
[[nodiscard]] bool solve_modes(Run& run, const linalg::Vector& start);
/// Goes from run.branch to better branches, until none is found: flips of biactive pairs with negative multipliers,
/// then the linear program over them. Leaves certificate and multipliers in run.solution.
void descend(Run& run);
/// Does the same for a branch that ought to be the solution: false, with the better one in run.branch, as soon as there
/// is one.
[[nodiscard]] bool remains(Run& run);
/// Adds to the certificate of run.branch what gradients of constraints and second derivatives say, if it is solved.
/// Leaves the set of its multipliers in run.solution.
void appraise(Run& run);
/// Helps where no branch was accepted: the linear program at the relaxed point proposes sides. Leaves run.branch if it
/// works.
void rescue(Run& run);
/// Finds certificate and multipliers of the relaxed point.
void certify_relaxed(Run& run);

}  // namespace saltus::solver
