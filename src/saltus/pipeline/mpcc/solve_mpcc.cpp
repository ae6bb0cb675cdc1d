#include "saltus/pipeline/mpcc/solve_mpcc.hpp"

#include <algorithm>
#include <limits>

#include <fmt/format.h>

#include "saltus/adapters/highs/highs_lpcc.hpp"
#include "saltus/adapters/ipopt/ipopt_solver.hpp"
#include "saltus/base/stopwatch.hpp"
#include "saltus/pipeline/mpcc/presolved_internal.hpp"
#include "saltus/pipeline/options/number_list_internal.hpp"

namespace saltus::pipeline {
namespace {

/// Without negative zeros, which say nothing.
Expected<std::optional<solver::Start>> start_at(const foreign::Problem& problem,
                                                const std::optional<std::vector<double>>& x) {
  if (!x) return std::optional<solver::Start>();
  const auto n = problem.file_variables();
  if (static_cast<int>(x->size()) != n) {
    return tl::unexpected(Error{ErrorCode::invalid_option,
                                fmt::format("the start has {} values, the problem {} variables", x->size(), n),
                                "start from a result of the same file",
                                {},
                                {}});
  }
  return solver::Start{problem.completed(linalg::ConstView(x->data(), n)), {}};
}

std::vector<result::MpccMultipliers::Range> ranges_of(const foreign::Problem& problem, Presolved& presolved,
                                                      const solver::Solution& solution) {
  std::vector<result::MpccMultipliers::Range> ranges;
  if (!solution.multiplier_set || solution.multiplier_set->is_unique()) return ranges;
  adapters::HighsLpcc linear;
  for (int i = 0; i < presolved.problem().constraints(); ++i) {
    const int row = presolved.row_of_whole(i);
    if (row >= problem.constraints()) continue;
    const auto range = solution.multiplier_set->of_row(i, linear);
    if (!range.is_unique()) ranges.push_back({row, problem.row_name(row), {range.lower, range.upper}});
  }
  return ranges;
}

result::OptimizationStatistics sizes_of(const foreign::Problem& problem) {
  result::OptimizationStatistics statistics;
  statistics.variables = problem.variables();
  statistics.equations = problem.constraints();
  statistics.pairs = problem.pairs();
  return statistics;
}

result::MpccResult result_of(const foreign::Problem& problem, Presolved& presolved, const solver::Solution& solution) {
  const auto n = problem.file_variables();
  result::MpccResult result;
  result.status.termination = solution.termination;
  result.status.message = solution.message;
  result.objective = problem.in_sense_of_file(solution.objective);
  result.x = list_of(solution.w.head(n));
  result.certificate = solution.certificate;
  const auto multipliers = presolved.multipliers_of_whole(solution);
  const auto of_file = [n](const linalg::Vector& all) {
    return list_of(all.head(std::min<linalg::Index>(n, all.size())));
  };
  result.multipliers = {list_of(multipliers.rows), of_file(multipliers.lower), of_file(multipliers.upper),
                        list_of(multipliers.G),    list_of(multipliers.H),     ranges_of(problem, presolved, solution)};
  result.homotopy = solution.homotopy;
  for (auto& step : result.homotopy) step.objective = problem.in_sense_of_file(step.objective);
  result.starts = solution.starts;
  for (auto& outcome : result.starts) outcome.objective = problem.in_sense_of_file(outcome.objective);
  result.statistics = sizes_of(problem);
  result.statistics.iterations = solution.iterations;
  result.statistics.evaluation_seconds = solution.evaluation_seconds;
  result.statistics.linear_algebra_seconds = solution.solver_seconds;
  return result;
}

/// Of a problem whose bounds contradict its rows: its start, and which rows.
result::MpccResult contradiction(foreign::Problem& problem, const mpcc::Presolve& found, const linalg::Vector& w) {
  result::MpccResult result;
  result.status.termination = result::Termination::infeasible;
  result.status.message = fmt::format("infeasible: {}", found.infeasible.front());
  if (found.infeasible.size() > 1) result.status.message += fmt::format("; and {} more", found.infeasible.size() - 1);
  result.objective = problem.in_sense_of_file(problem.objective(w));
  result.x = list_of(w.head(problem.file_variables()));
  auto& of = result.certificate;
  of.primal_infeasibility = of.complementarity_residual = of.stationarity = std::numeric_limits<double>::quiet_NaN();
  result.statistics = sizes_of(problem);
  return result;
}

}  // namespace

Expected<result::MpccResult> solve_mpcc(foreign::Problem& problem, const solver::SolveOptions& options,
                                        const std::optional<std::vector<double>>& x) {
  const auto start = start_at(problem, x);
  if (!start) return tl::unexpected(start.error());
  const Stopwatch stopwatch;
  adapters::IpoptSolver nlp(adapters::linear_solver_of(options.strategy));
  adapters::HighsLpcc lpcc;
  Presolved presolved(problem);
  result::MpccResult result;
  if (presolved.found().infeasible.empty()) {
    auto solution = solver::solve(presolved.problem(), nlp, lpcc, options, *start);
    if (!solution) return tl::unexpected(solution.error());
    result = result_of(problem, presolved, *solution);
  } else {
    result = contradiction(problem, presolved.found(), *start ? (*start)->w : problem.start());
  }
  result.names = problem.file_names();
  result.presolve = presolved.counts();
  result.tolerance = options.tolerance;
  result.statistics.wall_seconds = stopwatch.seconds();
  return result;
}

}  // namespace saltus::pipeline
