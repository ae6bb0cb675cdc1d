#include "saltus/pipeline/mpcc/solve_mpcc.hpp"

#include <fmt/format.h>

#include "saltus/adapters/highs/highs_lpcc.hpp"
#include "saltus/adapters/ipopt/ipopt_solver.hpp"
#include "saltus/base/stopwatch.hpp"
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
  return solver::Start{problem.complete(linalg::ConstView(x->data(), n)), {}};
}

result::MpccResult result_of(const foreign::Problem& problem, const solver::Solution& solution) {
  const auto n = problem.file_variables();
  result::MpccResult result;
  result.status.termination = solution.termination;
  result.status.message = solution.message;
  result.objective = problem.in_sense_of_file(solution.objective);
  result.x = list_of(solution.w.head(n));
  result.names = problem.file_names();
  result.certificate = solution.certificate;
  const auto& multipliers = solution.multipliers;
  const auto of_file = [n](const linalg::Vector& all) {
    return list_of(all.head(std::min<linalg::Index>(n, all.size())));
  };
  result.multipliers = {list_of(multipliers.rows), of_file(multipliers.lower), of_file(multipliers.upper),
                        list_of(multipliers.G), list_of(multipliers.H)};
  result.homotopy = solution.homotopy;
  for (auto& step : result.homotopy) step.objective = problem.in_sense_of_file(step.objective);
  result.starts = solution.starts;
  for (auto& outcome : result.starts) outcome.objective = problem.in_sense_of_file(outcome.objective);
  result.statistics.iterations = solution.iterations;
  result.statistics.variables = problem.variables();
  result.statistics.equations = problem.constraints();
  result.statistics.pairs = problem.pairs();
  result.statistics.evaluation_seconds = solution.evaluation_seconds;
  result.statistics.linear_algebra_seconds = solution.solver_seconds;
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
  auto solution = solver::solve(problem, nlp, lpcc, options, *start);
  if (!solution) return tl::unexpected(solution.error());
  auto result = result_of(problem, *solution);
  result.tolerance = options.tolerance;
  result.statistics.wall_seconds = stopwatch.seconds();
  return result;
}

}  // namespace saltus::pipeline
