#include <algorithm>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "saltus/adapters/highs/highs_lpcc.hpp"
#include "saltus/adapters/ipopt/ipopt_solver.hpp"
#include "saltus/solver/solve.hpp"
#include "small_problems.hpp"

namespace saltus::solver {
namespace {

/// A problem that begins where it is told to.
class Begun : public mpcc::PolynomialProblem {
 public:
  Begun(mpcc::PolynomialStatement statement, linalg::Vector start, linalg::Vector other)
      : PolynomialProblem(std::move(statement)), start_(std::move(start)), other_(std::move(other)) {}
  [[nodiscard]] linalg::Vector start() const override { return start_; }
  [[nodiscard]] std::vector<mpcc::NamedStart> other_starts() const override { return {{"the other one", other_}}; }

 private:
  linalg::Vector start_, other_;
};

/// min (w2^2 - 1)^2 + 0.3 w2 + w0 + w1, 0 <= w0 _|_ w1 >= 0: f = 0.29 near w2 = 1, and f = -0.31 near w2 = -1.
Begun two_valleys(double start, double other) {
  auto stated = small::statement(3, 1, {});
  stated.f = {{{1.0, {0, 0, 4}}, {-2.0, {0, 0, 2}}, {1.0, {}}, {0.3, {0, 0, 1}}, {1.0, {1}}, {1.0, {0, 1}}}};
  return {stated, linalg::Vector{0.0, 0.0, start}, linalg::Vector{0.0, 0.0, other}};
}

Expected<Solution> solved(Begun problem, const std::optional<Start>& start = std::nullopt,
                          const SolveOptions& options = {}) {
  adapters::IpoptSolver ipopt;
  adapters::HighsLpcc highs;
  return solve(problem, ipopt, highs, options, start);
}

bool has_compared(const Solution& solution) {
  return std::any_of(solution.homotopy.begin(), solution.homotopy.end(),
                     [](const auto& step) { return step.message == "begins at the other one"; });
}

/// Ipopt, and the tolerances that it was asked for.
class NotedTolerances final : public NlpSolver {
 public:
  [[nodiscard]] NlpReport solve(mpcc::Problem& nlp, NlpPoint& point, const NlpOptions& options) override {
    asked.push_back(options.tolerance);
    return ipopt_.solve(nlp, point, options);
  }
  [[nodiscard]] NlpReport follow(mpcc::Problem& nlp, NlpPoint& point, const NlpOptions& options, double first,
                                 int longest, const AskNextBarrier& next) override {
    return ipopt_.follow(nlp, point, options, first, longest, next);
  }
  [[nodiscard]] const char* name() const override { return "noted"; }

  std::vector<double> asked;

 private:
  adapters::IpoptSolver ipopt_;
};

TEST(ComparedStarts, TheirFirstProblemsAreSolvedAsFarAsTheNextOnesNeed) {
  Begun problem = two_valleys(1.2, -1.2);
  NotedTolerances noted;
  adapters::HighsLpcc highs;
  const auto found = solve(problem, noted, highs, {}, std::nullopt);
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->termination, result::Termination::completed);
  ASSERT_GE(noted.asked.size(), 4u);
  const double expected[] = {1e-3, 1e-4, 1e-3, 1e-4};  // sigma = 100 and 0.1 from both starts
  for (std::size_t k = 0; k < 4; ++k) EXPECT_DOUBLE_EQ(noted.asked[k], expected[k]);
}

TEST(ComparedStarts, TheLowerRelaxedObjectiveGoesOn) {
  const auto found = solved(two_valleys(1.2, -1.2));
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->termination, result::Termination::completed);
  EXPECT_NEAR(found->objective, -0.3054, 1e-3);
  EXPECT_TRUE(has_compared(*found));
}

TEST(ComparedStarts, AStartThatCostsMoreIsNotTried) {
  const auto found = solved(two_valleys(-1.2, 1.2));
  ASSERT_TRUE(found.has_value());
  EXPECT_NEAR(found->objective, -0.3054, 1e-3);
  EXPECT_FALSE(has_compared(*found));
}

/// Random starts are on either side of the hill at w2 = 0.08.
TEST(ComparedStarts, RandomStartsFindTheOtherValley) {
  SolveOptions options;
  const auto alone = solved(two_valleys(0.1, 0.1), std::nullopt, options);
  options.compared_starts = 4;
  const auto compared = solved(two_valleys(0.1, 0.1), std::nullopt, options);
  ASSERT_TRUE(alone.has_value() && compared.has_value());
  EXPECT_NEAR(compared->objective, -0.3054, 1e-3);
  const auto is_random = [](const auto& step) { return step.message.starts_with("begins at the random start"); };
  EXPECT_EQ(std::count_if(alone->homotopy.begin(), alone->homotopy.end(), is_random), 0);
  EXPECT_EQ(std::count_if(compared->homotopy.begin(), compared->homotopy.end(), is_random), 4);
}

TEST(ComparedStarts, GiveTheSameInThreads) {
  SolveOptions options;
  options.compared_starts = 6;
  const auto alone = solved(two_valleys(0.1, 0.1), std::nullopt, options);
  options.threads = 3;
  int made = 0;
  options.make_workplace = [&]() -> std::optional<Workplace> {
    ++made;
    return Workplace{std::unique_ptr<mpcc::Problem>(new Begun(two_valleys(0.1, 0.1))),
                     std::make_unique<adapters::IpoptSolver>(), std::make_unique<adapters::HighsLpcc>()};
  };
  const auto in_threads = solved(two_valleys(0.1, 0.1), std::nullopt, options);
  ASSERT_TRUE(alone.has_value() && in_threads.has_value());
  EXPECT_EQ(made, 2);
  EXPECT_EQ(in_threads->objective, alone->objective);
  EXPECT_EQ(in_threads->iterations, alone->iterations);
  ASSERT_EQ(in_threads->homotopy.size(), alone->homotopy.size());
  for (std::size_t i = 0; i < alone->homotopy.size(); ++i) {
    EXPECT_EQ(in_threads->homotopy[i].message, alone->homotopy[i].message);
    EXPECT_EQ(in_threads->homotopy[i].objective, alone->homotopy[i].objective);
  }
}

/// The limit is that of one start: random ones need no share of it.
TEST(ComparedStarts, RandomStartsTakeNoIterationsFromTheOthers) {
  SolveOptions options;
  const auto alone = solved(two_valleys(-1.2, 1.2), std::nullopt, options);
  ASSERT_TRUE(alone.has_value());
  options.compared_starts = 4;
  options.iteration_limit = alone->iterations + 10;
  const auto compared = solved(two_valleys(-1.2, 1.2), std::nullopt, options);
  ASSERT_TRUE(compared.has_value());
  EXPECT_EQ(compared->termination, result::Termination::completed) << compared->message;
}

TEST(ComparedStarts, AStartThatIsGivenIsTheOnlyOne) {
  const auto found = solved(two_valleys(1.2, -1.2), Start{.w = linalg::Vector{0.0, 0.0, 1.2}, .multipliers = {}});
  ASSERT_TRUE(found.has_value());
  EXPECT_NEAR(found->objective, 0.2946, 1e-3);
  EXPECT_FALSE(has_compared(*found));
}

}  // namespace
}  // namespace saltus::solver
