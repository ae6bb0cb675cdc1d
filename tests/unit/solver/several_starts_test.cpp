#include <algorithm>
#include <limits>
#include <memory>
#include <optional>

#include <gtest/gtest.h>

#include "../mpcc/polynomial_problem.hpp"
#include "saltus/adapters/highs/highs_lpcc.hpp"
#include "saltus/adapters/ipopt/ipopt_solver.hpp"
#include "saltus/solver/solve.hpp"

namespace saltus::solver {
namespace {

using result::Termination;

/// min (w^2 - 1)^2 + 0.3 w on [-2, 2]: two valleys, f = 0.29 near 1 and f = -0.31 near -1.
mpcc::PolynomialProblem two_valleys() {
  mpcc::PolynomialStatement statement;
  statement.variables = 1;
  statement.f = {{{1.0, {4}}, {-2.0, {2}}, {1.0, {}}, {0.3, {1}}}};
  statement.w_bounds = {linalg::Vector{-2.0}, linalg::Vector{2.0}};
  statement.g_bounds = {linalg::Vector(0), linalg::Vector(0)};
  return mpcc::PolynomialProblem(statement);
}

Expected<Solution> solved_from(std::optional<int> starts, int threads = 1, std::optional<int> seed = std::nullopt) {
  auto problem = two_valleys();
  adapters::IpoptSolver ipopt;
  adapters::HighsLpcc highs;
  SolveOptions options;
  options.starts = starts;
  options.threads = threads;
  options.seed = seed;
  options.make_workplace = []() -> std::optional<Workplace> {
    return Workplace{std::unique_ptr<mpcc::Problem>(new mpcc::PolynomialProblem(two_valleys())),
                     std::make_unique<adapters::IpoptSolver>(), std::make_unique<adapters::HighsLpcc>()};
  };
  return solve(problem, ipopt, highs, options, Start{.w = linalg::Vector{1.0}, .multipliers = {}});
}

TEST(SeveralStarts, GiveTheSameInThreads) {
  const auto alone = solved_from(8), in_threads = solved_from(8, 3);
  ASSERT_TRUE(alone.has_value() && in_threads.has_value());
  EXPECT_EQ(in_threads->objective, alone->objective);
  EXPECT_EQ(in_threads->iterations, alone->iterations);
  ASSERT_EQ(in_threads->starts.size(), alone->starts.size());
  for (std::size_t i = 0; i < alone->starts.size(); ++i) {
    EXPECT_EQ(in_threads->starts[i].objective, alone->starts[i].objective);
    EXPECT_EQ(in_threads->starts[i].is_taken, alone->starts[i].is_taken);
  }
}

TEST(SeveralStarts, OneAloneIsWhatItIsAmongAll) {
  const auto all = solved_from(8);
  ASSERT_TRUE(all.has_value());
  for (const auto& start : all->starts) {
    const auto one = solved_from(8, 1, start.seed);
    ASSERT_TRUE(one.has_value());
    EXPECT_EQ(one->objective, start.objective);
    EXPECT_EQ(one->iterations, start.iterations);
    ASSERT_EQ(one->starts.size(), 1u);
    EXPECT_EQ(one->starts.front().seed, start.seed);
    EXPECT_TRUE(one->starts.front().is_taken);
  }
}

TEST(SeveralStarts, FindTheLowerValley) {
  const auto one = solved_from(1);
  ASSERT_TRUE(one.has_value());
  EXPECT_GT(one->objective, 0.2);
  EXPECT_TRUE(one->starts.empty());

  const auto best = solved_from(8);
  ASSERT_TRUE(best.has_value());
  EXPECT_EQ(best->termination, Termination::completed);
  EXPECT_NEAR(best->objective, -0.3054, 1e-3);
  ASSERT_EQ(best->starts.size(), 8u);
  EXPECT_EQ(best->starts[0].seed, 0);
  EXPECT_EQ(best->starts[0].objective, one->objective);
  EXPECT_EQ(std::count_if(best->starts.begin(), best->starts.end(), [](const auto& start) { return start.is_taken; }),
            1);
  int iterations = 0;
  for (const auto& start : best->starts) {
    iterations += start.iterations;
    EXPECT_TRUE(start.objective >= best->objective);
    if (start.is_taken) {
      EXPECT_EQ(start.objective, best->objective);
    }
  }
  EXPECT_EQ(best->iterations, iterations);
}

TEST(SeveralStarts, FollowOnlyUntilOneIsCompleted) {
  const auto one = solved_from(1), enough = solved_from(std::nullopt);
  ASSERT_TRUE(one.has_value() && enough.has_value());
  EXPECT_EQ(enough->objective, one->objective);
  EXPECT_EQ(enough->iterations, one->iterations);
  EXPECT_TRUE(enough->starts.empty());

  // min w, ((w + 1)^2 + 0.1) (w - 4)^2 <= 1 on [-2, 6]: w = 3.79; near -1 the violation has a local minimum.
  mpcc::PolynomialStatement statement;
  statement.variables = 1;
  statement.f = {{{1.0, {1}}}};
  statement.g = {{{{1.0, {4}}, {-6.0, {3}}, {1.1, {2}}, {23.2, {1}}, {17.6, {}}}}};
  statement.w_bounds = {linalg::Vector{-2.0}, linalg::Vector{6.0}};
  statement.g_bounds = {linalg::Vector{-std::numeric_limits<double>::infinity()}, linalg::Vector{1.0}};
  mpcc::PolynomialProblem problem(statement);
  adapters::IpoptSolver ipopt;
  adapters::HighsLpcc highs;
  SolveOptions options;
  const Start start{.w = linalg::Vector{-0.9}, .multipliers = {}};
  const auto solved = solve(problem, ipopt, highs, options, start);
  ASSERT_TRUE(solved.has_value());
  EXPECT_EQ(solved->termination, Termination::completed);
  EXPECT_NEAR(solved->objective, 3.79176144491, 1e-8);
  ASSERT_GT(solved->starts.size(), 1u);
  EXPECT_NE(solved->starts.front().termination, Termination::completed);
  EXPECT_TRUE(solved->starts.back().is_taken);
  options.starts = 1;
  const auto from_there = solve(problem, ipopt, highs, options, start);
  ASSERT_TRUE(from_there.has_value());
  EXPECT_NE(from_there->termination, Termination::completed);
}

TEST(SeveralStarts, SeedsGiveTheSameStartsWithinBounds) {
  const double infinity = std::numeric_limits<double>::infinity();
  mpcc::PolynomialStatement statement;
  statement.variables = 3;
  statement.f = {{{1.0, {1}}}};
  statement.w_bounds = {linalg::Vector{-1.0, 0.0, -infinity}, linalg::Vector{3.0, infinity, infinity}};
  statement.g_bounds = {linalg::Vector(0), linalg::Vector(0)};
  const mpcc::PolynomialProblem problem(statement);
  const linalg::Vector w{0.0, 0.1, 40.0};
  EXPECT_TRUE(start_of_seed(problem, w, 0) == w);
  for (int seed = 1; seed < 100; ++seed) {
    const auto moved = start_of_seed(problem, w, seed);
    EXPECT_TRUE(moved == start_of_seed(problem, w, seed));
    EXPECT_FALSE(moved == start_of_seed(problem, w, seed + 1));
    EXPECT_GE(moved[0], -0.5);
    EXPECT_LE(moved[0], 1.5);
    EXPECT_GE(moved[1], 0.0);
    EXPECT_LE(std::abs(moved[2] - 40.0), 20.0);
  }
}

TEST(SeveralStarts, AreOneToAThousand) {
  EXPECT_FALSE(solved_from(0).has_value());
  const auto refused = solved_from(1001);
  ASSERT_FALSE(refused.has_value());
  EXPECT_EQ(refused.error().code, ErrorCode::invalid_option);
  EXPECT_NE(refused.error().message.find("1 to 1000"), std::string::npos);
}

}  // namespace
}  // namespace saltus::solver
