// The seam to solvers of smooth nonlinear programs.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "saltus/mpcc/problem.hpp"
#include "saltus/result/status.hpp"

namespace saltus::solver {

using mpcc::ConstVectorView;
using mpcc::VectorView;

/// Holds a primal and dual point of min f(w), lower_w <= w <= upper_w, lower_g <= g(w) <= upper_g:
///   grad f + (dg/dw)' y - z_lower + z_upper = 0.
struct NlpPoint {
  linalg::Vector w;
  linalg::Vector y;        ///< one per row of g; empty in a start without multipliers
  linalg::Vector z_lower;  ///< one per variable, >= 0
  linalg::Vector z_upper;
};

struct NlpOptions {
  double tolerance = 1e-12;            ///< of the solver's own scaled optimality error
  double acceptable_tolerance = 1e-6;  ///< taken if the solver cannot improve any more
  int iteration_limit = 500;
  std::optional<double> time_limit = {};  ///< seconds, of the wall clock
  /// Barrier parameter to begin with; the solver's own choice if absent. A start without multipliers is moved inside of
  /// its bounds by no more than this.
  std::optional<double> first_barrier_mu = {};
  /// Violation of the rows above which the Hessian is that of the objective alone: with multipliers that are far off,
  /// the curvature of constraints would only have to be regularised away.
  std::optional<double> curved_below = {};
  /// How far inside of its bounds a start with multipliers is moved.
  double warm_push = 1e-9;
  /// A solution with a larger objective is of no use: the solver may stop where it comes to one (not_converged).
  std::optional<double> objective_cutoff = {};
  /// Asked before every iteration: true ends the solution (stopped_by_user).
  std::function<bool()> is_interrupted = {};
};

struct NlpReport {
  /// completed (also at the acceptable tolerance), infeasible, iteration_limit, time_limit, stopped_by_user,
  /// evaluation_failed, factorization_failed, step_size_too_small, not_converged.
  result::Termination termination = result::Termination::not_converged;
  bool diverging = false;  ///< not_converged, since the iterates grow without bounds
  double objective = 0.0;
  int iterations = 0;
  double evaluation_seconds = 0.0;  ///< spent in functions of the problem
  std::string message;              ///< the solver's own words; empty if completed
};

/// Says how to go on behind a barrier problem that is solved.
struct NextBarrier {
  double mu = 0.1;  ///< > 0
  /// The values of the problem's functions have been changed; its bounds and patterns have not.
  bool is_changed = false;
};
/// Is asked wherever the barrier problem of mu is solved to 10 mu, or no step moves its point any more.
/// @param point       the iterate, with its multipliers
/// @param mu          its barrier parameter
/// @param iterations  since the loop began
/// Returns nothing where the loop ends.
using AskNextBarrier = std::function<std::optional<NextBarrier>(const NlpPoint& point, double mu, int iterations)>;

/// Solves smooth nonlinear programs: mpcc::Problems without pairs.
class NlpSolver {
 public:
  NlpSolver() = default;
  virtual ~NlpSolver() = default;
  NlpSolver(const NlpSolver&) = delete;
  NlpSolver& operator=(const NlpSolver&) = delete;

  /// Solves from `point` and leaves the last iterate there, whatever the outcome. Multipliers of the start are used if
  /// they are there.
  [[nodiscard]] virtual NlpReport solve(mpcc::Problem& nlp, NlpPoint& point, const NlpOptions& options) = 0;
  /// Solves barrier problems, one from the point of the other in a single loop, for as long as `next` gives another.
  /// Meanwhile `next` may change parameters of the problem, and solve other problems. The report says `completed` if
  /// `next` has ended the loop. Multipliers of the start are used if they are there, tolerances of `options` are not.
  /// @param first    the first barrier parameter
  /// @param longest  iterations of one barrier problem that are too many (step_size_too_small)
  [[nodiscard]] virtual NlpReport follow(mpcc::Problem& nlp, NlpPoint& point, const NlpOptions& options, double first,
                                         int longest, const AskNextBarrier& next) = 0;
  [[nodiscard]] virtual const char* name() const = 0;
};

}  // namespace saltus::solver
