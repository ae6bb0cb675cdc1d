// Problems with complementarities by a sequence of relaxed ones.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "saltus/base/error.hpp"
#include "saltus/base/function_ref.hpp"
#include "saltus/mpcc/residuals.hpp"
#include "saltus/solver/homotopy/relaxation.hpp"
#include "saltus/solver/homotopy/steering.hpp"
#include "saltus/solver/nlp_solver.hpp"

namespace saltus::solver::homotopy {

/// Gives sigma_0, sigma_0 factor, sigma_0 factor^2, ... down to sigma_final, which is the last.
struct Schedule {
  double sigma_initial = 1.0;  ///< > 0
  double sigma_factor = 0.1;   ///< in (0, 1)
  double sigma_final = 1e-10;  ///< > 0, <= sigma_initial

  /// Returns the sigma behind this one. The last factor is cut short; 1.0001 keeps rounding from adding one more
  /// problem at nearly the same sigma.
  [[nodiscard]] double next(double sigma) const {
    constexpr double rounding = 1.0001;
    return sigma_factor * sigma <= rounding * sigma_final ? sigma_final : sigma_factor * sigma;
  }
};

/// Says what the next relaxed problem starts with: after a large step of sigma old multipliers can mislead.
enum class WarmStart { primal, primal_dual };

struct PathOptions {
  Relaxation relaxation = Relaxation::scholtes;
  Schedule schedule;
  /// The path ends as soon as max_i G_i H_i is below.
  double complementarity_tolerance = 1e-9;
  /// Largest violation of the other constraints in a solution. Far above rounding, since the solver sees scaled ones.
  double feasibility_tolerance = 1e-8;
  WarmStart warm_start = WarmStart::primal;
  std::optional<double> time_limit;  ///< seconds, for the whole path
  NlpOptions nlp;
};

/// Holds one relaxed problem of the path, as it was left.
struct PathStep {
  double sigma = 0.0;
  NlpReport nlp;
  mpcc::Residuals residuals;  ///< of the problem with its complementarities, not of the relaxed one
};

struct PathResult {
  /// completed: the last relaxed problem was solved, or its solver stands still, and the point satisfies the original
  /// problem. verification_failed: it was solved, but its point does not. Else what the solver said about the last one.
  result::Termination termination = result::Termination::not_converged;
  std::string message;
  NlpPoint point;               ///< of the last relaxed problem, multipliers in its rows (RelaxedProblem)
  mpcc::Residuals residuals;    ///< at that point
  std::vector<PathStep> steps;  ///< one per relaxed problem
  int iterations = 0;           ///< of the solver, all together
};

/// Solves the relaxed problems for falling sigma, each from the solution of the one before. One that fails does not end
/// the path: the next may succeed from where it was left, as long as its values are finite.
/// Fails (invalid_option) for a schedule or tolerances outside their ranges.
/// @param on_step  called after each relaxed problem; false ends the path (stopped_by_user)
/// Source: [scholtes2001], and [hoheisel2013] for the comparison of the relaxations.
[[nodiscard]] Expected<PathResult> follow_path(
    mpcc::Problem& problem, ConstVectorView start, NlpSolver& solver, const PathOptions& options,
    FunctionRef<bool(const PathStep&)> on_step = [](const PathStep&) { return true; });

}  // namespace saltus::solver::homotopy
