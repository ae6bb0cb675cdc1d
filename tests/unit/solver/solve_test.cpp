#include "saltus/solver/solve.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "saltus/adapters/highs/highs_lpcc.hpp"
#include "saltus/adapters/ipopt/ipopt_solver.hpp"
#include "small_problems.hpp"

namespace saltus::solver {
namespace {

using homotopy::Relaxation;
using homotopy::Steering;
using result::StationarityType;
using result::Termination;
using small::infinity;

Solution solved(mpcc::Problem& problem, const linalg::Vector& start, const SolveOptions& options = {}) {
  adapters::IpoptSolver ipopt;
  adapters::HighsLpcc highs;
  SolveOptions from_there = options;
  from_there.starts = 1;
  auto solution = solve(problem, ipopt, highs, from_there, Start{.w = start, .multipliers = {}});
  EXPECT_TRUE(solution.has_value());
  return solution ? *solution : Solution{};
}

std::string log_of(const Solution& solution) {
  std::string text = solution.message + "\n";
  for (const auto& step : solution.homotopy) {
    text += std::string(result::name(step.phase)) + " sigma " + std::to_string(step.sigma) + " iterations " +
            std::to_string(step.iterations) + " f " + std::to_string(step.objective) + " " +
            std::string(result::name(step.termination)) + " " + step.message + "\n";
  }
  return text;
}

/// The certificate once more, from nothing but the problem, the point and the multipliers.
void expect_certified(mpcc::PolynomialProblem& problem, const Solution& solution, double tolerance) {
  const int n = problem.variables();
  const int n_g = problem.constraints();
  const int pairs = problem.pairs();
  linalg::Vector c(problem.rows());
  problem.functions(solution.w, c);
  linalg::Vector slope(n);
  problem.objective_gradient(solution.w, slope);
  linalg::Vector entries(problem.jacobian_pattern().entries());
  problem.jacobian(solution.w, entries);
  const auto& m = solution.multipliers;
  ASSERT_EQ(m.rows.size(), n_g);
  ASSERT_EQ(m.G.size(), pairs);
  for (int row = 0; row < problem.rows(); ++row) {
    const double y = row < n_g ? m.rows[row] : row < n_g + pairs ? -m.G[row - n_g] : -m.H[row - n_g - pairs];
    for (int i = 0; i < n; ++i) slope[i] += y * entries[row * n + i];
  }
  slope += m.upper - m.lower;
  EXPECT_LE(slope.max_abs(), tolerance);
  EXPECT_GE(m.lower.min(), 0.0);
  EXPECT_GE(m.upper.min(), 0.0);
  for (int i = 0; i < n; ++i) {
    if (m.lower[i] > tolerance) {
      EXPECT_NEAR(solution.w[i], problem.variable_bounds().lower[i], tolerance);
    }
    if (m.upper[i] > tolerance) {
      EXPECT_NEAR(solution.w[i], problem.variable_bounds().upper[i], tolerance);
    }
  }
  for (int row = 0; row < n_g; ++row) {
    EXPECT_GE(c[row], problem.constraint_bounds().lower[row] - tolerance);
    EXPECT_LE(c[row], problem.constraint_bounds().upper[row] + tolerance);
    if (m.rows[row] > tolerance) {
      EXPECT_NEAR(c[row], problem.constraint_bounds().upper[row], tolerance);
    }
    if (m.rows[row] < -tolerance) {
      EXPECT_NEAR(c[row], problem.constraint_bounds().lower[row], tolerance);
    }
  }
  for (int pair = 0; pair < pairs; ++pair) {
    const double G = c[n_g + pair];
    const double H = c[n_g + pairs + pair];
    EXPECT_GE(std::min(G, H), -tolerance);
    EXPECT_LE(std::min(G, H), tolerance);
    if (G > 10.0 * tolerance) {
      EXPECT_NEAR(m.G[pair], 0.0, tolerance);
    }
    if (H > 10.0 * tolerance) {
      EXPECT_NEAR(m.H[pair], 0.0, tolerance);
    }
  }
}

class EveryMethod : public testing::TestWithParam<std::tuple<Relaxation, Steering, bool>> {};

TEST_P(EveryMethod, MinimumOnOneAxis) {
  auto statement = small::minimum_on_one_axis();
  if (std::get<2>(GetParam())) small::imply_signs(statement);
  mpcc::PolynomialProblem problem(statement);
  if (std::get<2>(GetParam())) small::imply_signs(problem);
  SolveOptions options;
  options.relaxation = std::get<0>(GetParam());
  options.steering = std::get<1>(GetParam());
  const Solution solution = solved(problem, linalg::Vector{0.0, 5.0}, options);
  EXPECT_EQ(solution.termination, Termination::completed) << log_of(solution);
  EXPECT_TRUE(solution.crossed_over);
  EXPECT_NEAR(solution.w[0], 1.0, 1e-12);
  EXPECT_NEAR(solution.w[1], 0.0, 1e-12);
  EXPECT_NEAR(solution.objective, 0.0, 1e-12);
  EXPECT_EQ(solution.certificate.stationarity_type, StationarityType::S);
  expect_certified(problem, solution, 1e-10);

  options.crossover = false;
  const Solution relaxed = solved(problem, linalg::Vector{0.0, 5.0}, options);
  EXPECT_FALSE(relaxed.crossed_over);
  EXPECT_NEAR(relaxed.w[0], 1.0, 1e-6) << log_of(relaxed);
  EXPECT_NEAR(relaxed.w[1], 0.0, 1e-6) << log_of(relaxed);
}

INSTANTIATE_TEST_SUITE_P(All, EveryMethod,
                         testing::Combine(testing::ValuesIn(homotopy::all_relaxations),
                                          testing::ValuesIn(homotopy::all_steerings), testing::Bool()),
                         [](const auto& test) {
                           return std::string(name(std::get<0>(test.param))) + "_" +
                                  std::string(name(std::get<1>(test.param))) +
                                  (std::get<2>(test.param) ? "_implied" : "_constrained");
                         });

TEST(Solve, StronglyStationaryBiactivePoint) {
  // min (w0 + 1)^2 + (w1 + 2)^2: the origin, nu = (2, 4).
  mpcc::PolynomialProblem problem(small::statement(2, 1, small::distance(-1.0, -2.0)));
  const Solution solution = solved(problem, linalg::Vector{1.0, 1.0});
  EXPECT_EQ(solution.termination, Termination::completed) << log_of(solution);
  EXPECT_NEAR(solution.w.norm(), 0.0, 1e-12);
  EXPECT_EQ(solution.certificate.stationarity_type, StationarityType::S);
  EXPECT_EQ(solution.certificate.biactive, 1);
  EXPECT_NEAR(solution.multipliers.G[0], 2.0, 1e-9);
  EXPECT_NEAR(solution.multipliers.H[0], 4.0, 1e-9);
  EXPECT_EQ(solution.certificate.lpcc_decrease, std::nullopt);
  expect_certified(problem, solution, 1e-9);
}

TEST(Solve, NotStronglyButBStationary) {
  mpcc::PolynomialProblem problem(small::b_not_strong());
  const Solution solution = solved(problem, linalg::Vector{0.0, 1.0, 0.0});
  EXPECT_EQ(solution.termination, Termination::completed) << log_of(solution);
  EXPECT_NEAR(solution.w.norm(), 0.0, 1e-10);
  // Rows (3/4, 1/4) leave -2 and 0 to the sides of the pair: it is M, whichever multipliers were found.
  EXPECT_EQ(solution.certificate.stationarity_type, StationarityType::M);
  EXPECT_EQ(solution.certificate.unique_multipliers, false);
  EXPECT_EQ(solution.certificate.b_stationary, true);
  ASSERT_TRUE(solution.certificate.lpcc_decrease.has_value());
  EXPECT_NEAR(*solution.certificate.lpcc_decrease, 0.0, 1e-9);
  expect_certified(problem, solution, 1e-9);
}

TEST(Solve, Infeasible) {
  auto statement = small::statement(2, 1, small::distance(1.0, 1.0));
  small::add_row(statement, {{{1.0, {1, 1}}}}, 1.0, 1.0);  // w0 w1 = 1
  mpcc::PolynomialProblem problem(statement);
  const Solution solution = solved(problem, linalg::Vector{1.0, 1.0});
  EXPECT_EQ(solution.termination, Termination::infeasible) << log_of(solution);
  EXPECT_NE(solution.message.find("G[0]"), std::string::npos) << solution.message;
  EXPECT_EQ(solution.certificate.stationarity_type, std::nullopt);
}

/// The relaxed problems have no solution either, but iterates go to infinity so slowly that no solver says so.
TEST(Solve, UnboundedAlongOneSideEndsAtOnce) {
  mpcc::PolynomialProblem problem(small::statement(2, 1, {{{1.0, {1}}, {-1.0, {0, 1}}}}));
  const Solution solution = solved(problem, linalg::Vector{0.1, 0.1});
  EXPECT_EQ(solution.termination, Termination::not_converged) << log_of(solution);
  EXPECT_TRUE(solution.is_unbounded);
  EXPECT_NE(solution.message.find("unbounded"), std::string::npos) << solution.message;
  EXPECT_LE(solution.iterations, 1000);
}

TEST(Solve, Unbounded) {
  mpcc::PolynomialProblem problem(small::statement(2, 1, {{{-1.0, {1}}, {-1.0, {0, 1}}}}));
  const Solution solution = solved(problem, linalg::Vector{1.0, 2.0});
  EXPECT_EQ(solution.termination, Termination::not_converged) << log_of(solution);
  EXPECT_NE(solution.message.find("unbounded"), std::string::npos) << solution.message;
}

TEST(Solve, ClarkePointOfThePathIsNoSolution) {
  // min (w0 - 1)^2 + (w1 - 1)^2: on the diagonal the relaxed problems lead to the origin, nu = (-2, -2).
  mpcc::PolynomialProblem problem(small::statement(2, 1, small::distance(1.0, 1.0)));
  SolveOptions options;
  options.crossover = false;
  options.strategy = Strategy::ipopt;  // the loop leaves the diagonal by its rounding
  options.schedule.sigma_final = 1e-3;
  options.tolerance = 0.04;  // the sides are sqrt(sigma_final) = 0.032 there
  const Solution clarke = solved(problem, linalg::Vector{0.5, 0.5}, options);
  EXPECT_EQ(clarke.termination, Termination::not_converged) << log_of(clarke);
  EXPECT_EQ(clarke.certificate.stationarity_type, StationarityType::C);
  EXPECT_EQ(clarke.certificate.b_stationary, false);
  EXPECT_NEAR(clarke.certificate.lpcc_decrease.value_or(0.0), -1.0, 0.05);
  EXPECT_NE(clarke.message.find("not B-stationary"), std::string::npos) << clarke.message;

  const Solution solution = solved(problem, linalg::Vector{0.5, 0.5});
  EXPECT_EQ(solution.termination, Termination::completed) << log_of(solution);
  EXPECT_NEAR(solution.objective, 1.0, 1e-12);
}

TEST(Solve, ANonlinearProgramIsAProblemWithoutPairs) {
  auto statement = small::statement(2, 0, small::distance(2.0, 1.0));
  small::add_row(statement, {{{1.0, {1}}, {1.0, {0, 1}}}}, -infinity, 1.0);
  mpcc::PolynomialProblem problem(statement);
  const Solution solution = solved(problem, linalg::Vector{0.0, 0.0});
  EXPECT_EQ(solution.termination, Termination::completed) << log_of(solution);
  EXPECT_NEAR(solution.w[0], 1.0, 1e-12);
  EXPECT_NEAR(solution.multipliers.rows[0], 2.0, 1e-10);
  EXPECT_EQ(solution.homotopy.size(), 2u);  // one problem and its last digits
  expect_certified(problem, solution, 1e-10);
}

TEST(Solve, StopsWhereItIsToldTo) {
  mpcc::PolynomialProblem problem(small::b_not_strong());
  const linalg::Vector start{0.0, 1.0, 0.0};
  SolveOptions options;
  int asked = 0;
  options.is_interrupted = [&asked] { return ++asked > 8; };
  const Solution interrupted = solved(problem, start, options);
  EXPECT_EQ(interrupted.termination, Termination::stopped_by_user) << log_of(interrupted);
  EXPECT_LE(interrupted.iterations, 9);
  EXPECT_TRUE(interrupted.w.all_finite());

  options = {};
  options.time_limit = 1e-9;
  EXPECT_EQ(solved(problem, start, options).termination, Termination::time_limit);

  options = {};
  options.iteration_limit = 10;
  const Solution limited = solved(problem, start, options);
  EXPECT_EQ(limited.termination, Termination::iteration_limit) << log_of(limited);
  EXPECT_LE(limited.iterations, 10);
}

/// Needs that many iterations for every problem; with fewer it leaves a point that is not quite feasible.
class SlowSolver final : public NlpSolver {
 public:
  explicit SlowSolver(int needed) : needed_(needed) {}
  [[nodiscard]] NlpReport solve(mpcc::Problem& nlp, NlpPoint& point, const NlpOptions& options) override {
    NlpOptions enough = options;
    enough.iteration_limit = 500;
    NlpReport report = ipopt_.solve(nlp, point, enough);
    report.iterations = std::min(needed_, options.iteration_limit);
    if (options.iteration_limit >= needed_) return report;
    report.termination = Termination::iteration_limit;
    point.w.add_to_all(1e-7);
    point.y.add_to_all(10.0);  // so that no last digits are found
    return report;
  }
  [[nodiscard]] NlpReport follow(mpcc::Problem& nlp, NlpPoint& point, const NlpOptions& options, double first,
                                 int longest, const AskNextBarrier& next) override {
    return ipopt_.follow(nlp, point, options, first, longest, next);
  }
  [[nodiscard]] const char* name() const override { return "slow"; }

 private:
  adapters::IpoptSolver ipopt_;
  int needed_;
};

/// min (w0 - 1)^2 + w1^3 + w1^2 with w0 (w0 + 1) = w2 = 2, from its branch.
Solution solved_slowly(int needed, int limit) {
  auto statement = small::minimum_on_one_axis();
  statement.variables = 3;
  statement.w_bounds = {linalg::Vector::constant(3, -infinity), linalg::Vector::constant(3, infinity)};
  small::add_row(statement, {{{1.0, {2}}, {1.0, {1}}, {-1.0, {0, 0, 1}}}}, 0.0, 0.0);
  small::add_row(statement, {{{1.0, {0, 0, 2}}}}, 4.0, 4.0);
  mpcc::PolynomialProblem problem(statement);
  SlowSolver slow(needed);
  adapters::HighsLpcc highs;
  SolveOptions options;
  options.first = FirstProblem::branch;
  options.iteration_limit = limit;
  auto solution = solve(problem, slow, highs, options, Start{.w = linalg::Vector{3.0, 0.0, 1.0}, .multipliers = {}});
  EXPECT_TRUE(solution.has_value());
  return solution ? *solution : Solution{};
}

TEST(Solve, ABranchOfTheStartIsSolvedInOneGo) {
  const Solution solution = solved_slowly(1200, 3000);
  EXPECT_EQ(solution.termination, Termination::completed) << log_of(solution);
  EXPECT_EQ(solution.homotopy.size(), 1u) << log_of(solution);
}

TEST(Solve, ABranchOfTheStartIsKeptWhereALimitEndsIt) {
  const Solution solution = solved_slowly(1200, 900);
  EXPECT_EQ(solution.termination, Termination::iteration_limit) << log_of(solution);
  EXPECT_TRUE(solution.crossed_over);
  EXPECT_NEAR(solution.w[0], 1.0, 1e-6);
  EXPECT_GT(solution.certificate.primal_infeasibility, 1e-8);
}

bool has_relaxed(const Solution& solution) {
  return std::any_of(solution.homotopy.begin(), solution.homotopy.end(),
                     [](const auto& step) { return step.phase == result::HomotopyPhase::relaxed; });
}

/// min (w0 - a)^2 + (w1 - b)^2, 0 <= w0, 0 <= w1, one of them 0.
Solution solved_again(double a, double b, const Start& start, const SolveOptions& options = {}) {
  mpcc::PolynomialProblem problem(
      small::statement(2, 1, {{{1.0, {2}}, {-2.0 * a, {1}}, {1.0, {0, 2}}, {-2.0 * b, {0, 1}}}}));
  adapters::IpoptSolver ipopt;
  adapters::HighsLpcc highs;
  auto solution = solve(problem, ipopt, highs, options, start);
  EXPECT_TRUE(solution.has_value());
  return solution ? std::move(*solution) : Solution{};
}

TEST(Solve, AStartThatSolvesASimilarProblemIsTakenAsASolution) {
  const Solution first = solved_again(2.0, 1.0, {.w = linalg::Vector{1.0, 1.0}, .multipliers = {}});
  EXPECT_TRUE(has_relaxed(first)) << log_of(first);
  const Solution next = solved_again(2.5, 1.0, {.w = first.w, .multipliers = first.multipliers});
  EXPECT_FALSE(has_relaxed(next)) << log_of(next);
  EXPECT_EQ(next.termination, Termination::completed) << log_of(next);
  EXPECT_NEAR(next.w[0], 2.5, 1e-8);
}

/// (0, 1) first; then the branch of w0 = 0 ends in (0, 0), and (3, 0) beside it is better.
TEST(Solve, AStartWhoseActiveSetIsNotTheBestIsLeft) {
  const Solution first = solved_again(-1.0, 1.0, {.w = linalg::Vector{0.5, 0.5}, .multipliers = {}});
  ASSERT_NEAR(first.w[1], 1.0, 1e-8) << log_of(first);
  const Solution next = solved_again(3.0, -1.0, {.w = first.w, .multipliers = first.multipliers});
  EXPECT_EQ(next.homotopy.front().message, "sides of the start") << log_of(next);
  EXPECT_TRUE(has_relaxed(next)) << log_of(next);
  EXPECT_EQ(next.termination, Termination::completed) << log_of(next);
  EXPECT_NEAR(next.w[0], 3.0, 1e-8) << log_of(next);
}

TEST(Solve, OtherStartsBeginWithRelaxedProblems) {
  const Solution first = solved_again(2.0, 1.0, {.w = linalg::Vector{1.0, 1.0}, .multipliers = {}});
  const Start point{.w = first.w, .multipliers = {}},
      beside{.w = linalg::Vector{2.0, 0.5}, .multipliers = first.multipliers};
  EXPECT_TRUE(has_relaxed(solved_again(2.5, 1.0, point)));
  EXPECT_TRUE(has_relaxed(solved_again(2.5, 1.0, beside)));
  SolveOptions options;
  options.sigma_initial = 1e-3;
  EXPECT_TRUE(has_relaxed(solved_again(2.5, 1.0, {.w = first.w, .multipliers = first.multipliers}, options)));
  options.sigma_initial.reset();
  options.first = FirstProblem::relaxed;
  EXPECT_TRUE(has_relaxed(solved_again(2.5, 1.0, {.w = first.w, .multipliers = first.multipliers}, options)));
}

TEST(Solve, EveryProblemIsReported) {
  mpcc::PolynomialProblem problem(small::minimum_on_one_axis());
  SolveOptions options;
  std::size_t reported = 0;
  options.on_step = [&reported](const result::HomotopyStep&) { ++reported; };
  const Solution solution = solved(problem, linalg::Vector{0.0, 5.0}, options);
  EXPECT_EQ(reported, solution.homotopy.size());
  int iterations = 0;
  for (const auto& step : solution.homotopy) iterations += step.iterations;
  EXPECT_EQ(iterations, solution.iterations);
  EXPECT_GT(solution.evaluation_seconds, 0.0);
  EXPECT_GT(solution.solver_seconds, 0.0);
}

TEST(Solve, WarmStartsWithMultipliersReachTheSamePoint) {
  mpcc::PolynomialProblem problem(small::minimum_on_one_axis());
  SolveOptions options;
  options.warm_start = homotopy::WarmStart::primal_dual;
  const Solution solution = solved(problem, linalg::Vector{0.0, 5.0}, options);
  EXPECT_EQ(solution.termination, Termination::completed) << log_of(solution);
  EXPECT_NEAR(solution.w[0], 1.0, 1e-12);
}

TEST(Solve, RefusesBadInput) {
  adapters::IpoptSolver ipopt;
  adapters::HighsLpcc highs;
  mpcc::PolynomialProblem problem(small::minimum_on_one_axis());
  SolveOptions options;
  options.schedule.sigma_factor = 1.0;
  EXPECT_EQ(solve(problem, ipopt, highs, options).error().code, ErrorCode::invalid_option);
  auto undefined = small::minimum_on_one_axis();
  small::add_row(undefined, {{{1.0, {-1}}}}, 0.0, infinity);  // 1 / w0 at 0
  mpcc::PolynomialProblem singular(undefined);
  const auto refused = solve(singular, ipopt, highs, {});
  ASSERT_FALSE(refused.has_value());
  EXPECT_EQ(refused.error().code, ErrorCode::invalid_model);
  EXPECT_NE(refused.error().message.find("g[0]"), std::string::npos) << refused.error().message;
}

}  // namespace
}  // namespace saltus::solver
