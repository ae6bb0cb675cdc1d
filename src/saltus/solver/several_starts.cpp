#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <optional>
#include <random>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "saltus/base/at.hpp"
#include "saltus/base/stopwatch.hpp"
#include "saltus/result/better_start.hpp"
#include "saltus/solver/run_internal.hpp"
#include "saltus/solver/workplaces_internal.hpp"

namespace saltus::solver {
namespace {

using result::Termination;

constexpr int most_starts = 1000;
/// Where the given start leads to no solution: of motions between nodes one start in 20 to one in 3 does.
constexpr int usual_starts = 25;
/// How far the way from the given start to a random point is gone.
constexpr double way = 0.5;

double worst_violation(const Solution& solution) {
  const auto& of = solution.certificate;
  return std::max(of.primal_infeasibility, of.complementarity_residual);
}

result::StartOutcome outcome_of(const Solution& solution, int seed, double seconds) {
  return {.seed = seed,
          .termination = solution.termination,
          .objective = solution.objective,
          .infeasibility = worst_violation(solution),
          .iterations = solution.iterations,
          .seconds = seconds};
}

/// Whether no other start is needed, or wanted.
bool ends_all(const Solution& solution, const SolveOptions& options) {
  const auto why = solution.termination;
  if (why == Termination::time_limit || why == Termination::stopped_by_user) return true;
  return !options.starts && (why == Termination::completed || solution.is_unbounded);
}

/// What one start has come to; nothing where others have ended all before.
struct Tried {
  std::optional<Expected<Solution>> found;
  double seconds = 0.0;
};

Expected<Solution> best_of(std::vector<Tried> all) {
  if (!*all.front().found) return std::move(*all.front().found);
  std::vector<result::StartOutcome> outcomes;
  int iterations = 0;
  for (std::size_t seed = 0; seed < all.size(); ++seed) {
    const auto& [found, seconds] = all[seed];
    if (!found || !*found) continue;  // a function is not finite there, or there was no time
    outcomes.push_back(outcome_of(**found, static_cast<int>(seed), seconds));
    iterations += outcomes.back().iterations;
  }
  const auto taken = std::min_element(outcomes.begin(), outcomes.end(), result::is_better);  // the first of equals
  taken->is_taken = true;
  Solution best = std::move(**all[at(taken->seed)].found);
  if (outcomes.size() > 1) best.starts = std::move(outcomes);
  best.iterations = iterations;
  return best;
}

/// Seed 0 is the given start; others begin beside w.
std::optional<Start> moved_start(const mpcc::Problem& problem, const std::optional<Start>& start,
                                 const linalg::Vector& w, int seed) {
  if (seed == 0) return start;
  return Start{.w = start_of_seed(problem, w, seed), .multipliers = {}};
}

Expected<Solution> solve_one(mpcc::Problem& problem, NlpSolver& nlp, LpccSolver& lpcc, const SolveOptions& options,
                             const std::optional<Start>& start) {
  const Stopwatch stopwatch;
  auto solution = solve_from(problem, nlp, lpcc, options,
                             moved_start(problem, start, start ? start->w : problem.start(), *options.seed));
  if (!solution) return solution;
  solution->starts.push_back(outcome_of(*solution, *options.seed, stopwatch.seconds()));
  solution->starts.back().is_taken = true;
  return solution;
}

}  // namespace

std::optional<double> time_left(const SolveOptions& options, double seconds) {
  constexpr double least = 1e-3;  // a time limit is > 0
  return options.time_limit ? std::optional(std::max(*options.time_limit - seconds, least)) : std::nullopt;
}

bool is_over(const SolveOptions& options, double seconds) {
  const bool is_interrupted = options.is_interrupted && options.is_interrupted();
  return is_interrupted || (options.time_limit && seconds >= *options.time_limit);
}

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
  if (options.seed) return solve_one(problem, nlp, lpcc, options, start);
  const int count = options.starts.value_or(usual_starts);
  if (count < 1 || count > most_starts) {
    Error error;
    error.code = ErrorCode::invalid_option;
    error.message = fmt::format("starts = {} is not from 1 to {}", count, most_starts);
    return tl::unexpected(std::move(error));
  }
  if (count == 1) return solve_from(problem, nlp, lpcc, options, start);
  const linalg::Vector w = start ? start->w : problem.start();
  std::vector<Tried> all(at(count));
  const Stopwatch stopwatch;
  std::atomic<bool> is_over = false;
  const auto from_seed = [&](int seed, const Place& place) {
    if (seed > 0 && is_over) return;
    SolveOptions one = options;
    one.is_interrupted = place.is_interrupted;
    one.time_limit = time_left(options, stopwatch.seconds());
    // Other threads do not report.
    if (&place.problem != &problem) one.on_step = [](const result::HomotopyStep&) {};
    const Stopwatch own;
    auto& tried = all[at(seed)];
    tried.found = solve_from(place.problem, place.nlp, place.lpcc, one, moved_start(problem, start, w, seed));
    tried.seconds = own.seconds();
    const bool has_failed = seed == 0 && !*tried.found;
    if (has_failed || (*tried.found && ends_all(**tried.found, options))) is_over = true;
  };
  // Which is the first that is completed may not depend on who is faster.
  SolveOptions sharing = options;
  if (!options.starts) sharing.threads = 1;
  share_out({problem, nlp, lpcc}, sharing, count, from_seed);
  return best_of(std::move(all));
}

}  // namespace saltus::solver
