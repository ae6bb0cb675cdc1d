#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>

#include <fmt/format.h>

#include "saltus/base/stopwatch.hpp"
#include "saltus/solver/run_internal.hpp"

namespace saltus::solver {
namespace {

using result::Termination;

constexpr int most_starts = 1000;
/// How far the way from the given start to a random point is gone.
constexpr double way = 0.5;
/// A time limit is > 0.
constexpr double least_seconds = 1e-3;

double worst_violation(const Solution& solution) {
  const auto& of = solution.certificate;
  return std::max(of.primal_infeasibility, of.complementarity_residual);
}

/// A completed one before others, then the lower objective; of others the one that violates less.
bool is_better(const Solution& a, const Solution& b) {
  const bool a_done = a.termination == Termination::completed, b_done = b.termination == Termination::completed;
  if (a_done != b_done) return a_done;
  return a_done ? a.objective < b.objective : worst_violation(a) < worst_violation(b);
}

bool ends_all(const Solution& solution) {
  return solution.termination == Termination::time_limit || solution.termination == Termination::stopped_by_user;
}

}  // namespace

linalg::Vector start_of_seed(const mpcc::Problem& problem, ConstVectorView w, int seed) {
  linalg::Vector moved = w;
  if (seed == 0) return moved;
  std::mt19937_64 random(static_cast<std::uint64_t>(seed));
  constexpr double unit = 0x1p-53;
  const auto& [lower, upper] = problem.variable_bounds();
  for (linalg::Index i = 0; i < moved.size(); ++i) {
    const double part = static_cast<double>(random() >> 11U) * unit;  // in [0, 1), by the digits alone
    const double reach = std::max(1.0, std::abs(w[i]));
    const bool is_bounded = std::isfinite(lower[i]) && std::isfinite(upper[i]);
    const double point = is_bounded ? lower[i] + part * (upper[i] - lower[i]) : w[i] + (2.0 * part - 1.0) * reach;
    moved[i] = std::clamp(w[i] + way * (point - w[i]), lower[i], upper[i]);
  }
  return moved;
}

Expected<Solution> solve(mpcc::Problem& problem, NlpSolver& nlp, LpccSolver& lpcc, const SolveOptions& options,
                         const std::optional<Start>& start) {
  if (options.starts < 1 || options.starts > most_starts) {
    Error error;
    error.code = ErrorCode::invalid_option;
    error.message = fmt::format("starts = {} is not from 1 to {}", options.starts, most_starts);
    return tl::unexpected(std::move(error));
  }
  if (options.starts == 1) return solve_from(problem, nlp, lpcc, options, start);
  const Stopwatch stopwatch;
  const linalg::Vector w = start ? start->w : problem.start();
  std::optional<Solution> best;
  std::vector<result::StartOutcome> outcomes;
  int iterations = 0, taken = 0;
  for (int seed = 0; seed < options.starts; ++seed) {
    SolveOptions one = options;
    if (options.time_limit) one.time_limit = std::max(*options.time_limit - stopwatch.seconds(), least_seconds);
    const double began = stopwatch.seconds();
    const Start moved{.w = start_of_seed(problem, w, seed), .multipliers = {}};
    auto found = solve_from(problem, nlp, lpcc, one, seed == 0 ? start : std::optional(moved));
    if (!found && seed == 0) return found;
    if (!found) continue;  // a function is not finite there
    iterations += found->iterations;
    outcomes.push_back({.seed = seed,
                        .termination = found->termination,
                        .objective = found->objective,
                        .infeasibility = worst_violation(*found),
                        .iterations = found->iterations,
                        .seconds = stopwatch.seconds() - began});
    const bool is_end = ends_all(*found);
    if (!best || is_better(*found, *best)) {
      best = std::move(*found);
      taken = seed;
    }
    if (is_end) break;
  }
  for (auto& outcome : outcomes) outcome.is_taken = outcome.seed == taken;
  best->starts = std::move(outcomes);
  best->iterations = iterations;
  return std::move(*best);
}

}  // namespace saltus::solver
