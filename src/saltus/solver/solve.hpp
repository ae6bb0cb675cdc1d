// Solves a mathematical program with complementarity constraints: relaxed problems, branch problems, certificate.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "saltus/base/error.hpp"
#include "saltus/mpcc/problem.hpp"
#include "saltus/result/optimization.hpp"
#include "saltus/solver/certificate/multiplier_set.hpp"
#include "saltus/solver/homotopy/follow_path.hpp"
#include "saltus/solver/lpcc_solver.hpp"
#include "saltus/solver/multipliers.hpp"
#include "saltus/solver/nlp_solver.hpp"
#include "saltus/solver/strategy.hpp"

namespace saltus::solver {

/// Names the problem that a solution begins with.
enum class FirstProblem {
  automatic,  ///< `branch` for a start that solves a similar problem, else `relaxed`
  relaxed,    ///< that of the first sigma
  branch,     ///< that of the sides of the start, which are right where it is a solution of a similar problem
  modes,      ///< likewise, but sides that lead to no solution are changed: those of a motion that is only similar
};

/// Holds what one thread solves with.
struct Workplace {
  std::unique_ptr<mpcc::Problem> problem;
  std::unique_ptr<NlpSolver> nlp;
  std::unique_ptr<LpccSolver> lpcc;
};

/// Holds [optimize.mpcc] (docs/options.md).
struct SolveOptions {
  Strategy strategy = Strategy::structured;
  homotopy::Relaxation relaxation = homotopy::Relaxation::scholtes;
  homotopy::Steering steering = homotopy::Steering::direct;
  homotopy::Schedule schedule{};
  /// Of the first relaxed problem, instead of the schedule's. Without it, two are compared where the relaxed problems
  /// are solved in one loop: the schedule's over its factor squared (100), and times its factor (0.1).
  std::optional<double> sigma_initial{};
  homotopy::WarmStart warm_start = homotopy::WarmStart::primal;
  FirstProblem first = FirstProblem::automatic;
  bool crossover = true;
  /// The start itself, and others by seeds 1, 2, ...: all of them. Nothing: one after the other, until one is
  /// completed.
  std::optional<int> starts{};
  /// Solves from the start of this seed alone, for machines that share the starts; `starts` is not looked at then.
  std::optional<int> seed{};
  /// Random starts by seeds 1, 2, ... of which the first relaxed problem alone is solved, and compared: the path of the
  /// lowest objective goes on. Nothing is 0.
  std::optional<int> compared_starts{};
  int threads = 1;  ///< for starts; results do not depend on it
  /// Makes a copy of the problem for another thread, with solvers of its own; called there. Empty: no other threads.
  std::function<std::optional<Workplace>()> make_workplace{};
  double tolerance = 1e-8;             ///< of the three residuals
  int iteration_limit = 3000;          ///< of all relaxed and branch problems of a start together
  std::optional<double> time_limit{};  ///< seconds
  /// Ends everything at the next iteration of the solver (stopped_by_user). Called by the thread that calls solve().
  std::function<bool()> is_interrupted = [] { return false; };
  /// Called after every problem.
  std::function<void(const result::HomotopyStep&)> on_step = [](const result::HomotopyStep&) {};
};

/// Holds the best point found, whatever the outcome; everything without the method's own terms.
struct Solution {
  /// completed: residuals <= tolerance and B-stationary. infeasible, iteration_limit, time_limit, stopped_by_user,
  /// evaluation_failed, else not_converged (not stationary, not B-stationary, unbounded): `message` says which.
  result::Termination termination = result::Termination::not_converged;
  std::string message;
  double objective = 0.0;
  linalg::Vector w;
  MpccMultipliers multipliers;
  std::optional<certificate::MultiplierSet> multiplier_set;  ///< of the branch problem that w solves
  result::Certificate certificate;
  std::vector<result::HomotopyStep> homotopy;
  std::vector<result::StartOutcome> starts;  ///< where there were several
  bool is_unbounded = false;                 ///< the iterates grow without limit while the objective falls
  bool crossed_over = false;                 ///< w solves a branch problem, whose sides are `sides`
  std::vector<mpcc::ActiveSide> sides;
  int iterations = 0;
  double evaluation_seconds = 0.0, solver_seconds = 0.0;
};

/// Says where to begin; multipliers may be empty. With multipliers, and pairs that are complementary, it is taken as a
/// solution of a similar problem (FirstProblem::automatic).
struct Start {
  linalg::Vector w;
  MpccMultipliers multipliers;
};

/// Solves from a motion: the branch of its sides, then better ones beside it. Where no point of that branch satisfies
/// the constraints, the point where its solver stands is returned as not converged, without a certificate.
[[nodiscard]] Solution solve_motion(mpcc::Problem& problem, NlpSolver& nlp, LpccSolver& lpcc,
                                    const SolveOptions& options, const mpcc::NamedStart& motion);

/// Returns the time limit of what begins after so many seconds.
[[nodiscard]] std::optional<double> time_left(const SolveOptions& options, double seconds);

/// Returns whether what has taken so many seconds is interrupted, or its time is up.
[[nodiscard]] bool is_over(const SolveOptions& options, double seconds);

/// Returns the start of a seed: 0 the given one, else one half way from it to a random point, which is drawn between
/// finite bounds, else within max(1, |w|) of w. Same seed, same bits on every machine.
[[nodiscard]] linalg::Vector start_of_seed(const mpcc::Problem& problem, ConstVectorView w, int seed);

/// Solves from problem.start(), or from `start`; with several starts from each, and gives the best: of those that are
/// completed the one with the lowest objective, else the one that violates the least. Then iterations are those of all.
/// Fails (invalid_option) for a schedule or tolerances outside their ranges, and (invalid_model) if a function is not
/// finite at the start: the message names it.
[[nodiscard]] Expected<Solution> solve(mpcc::Problem& problem, NlpSolver& nlp, LpccSolver& lpcc,
                                       const SolveOptions& options, const std::optional<Start>& start = std::nullopt);

}  // namespace saltus::solver
