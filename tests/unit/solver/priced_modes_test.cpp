#include <vector>

#include <gtest/gtest.h>

#include "saltus/adapters/highs/highs_lpcc.hpp"
#include "saltus/adapters/ipopt/ipopt_solver.hpp"
#include "saltus/solver/crossover/priced_sides.hpp"
#include "saltus/solver/solve.hpp"
#include "small_problems.hpp"

namespace saltus::solver {
namespace {

using mpcc::ActiveSide;

/// min (w0 - 1)^2 + w1^3 + w1^2, w0 >= 0.5: w0 = 0 is no side that has a solution.
mpcc::PolynomialStatement off_one_axis() {
  auto stated = small::minimum_on_one_axis();
  small::add_row(stated, {{{1.0, {1}}}}, 0.5, small::infinity);
  return stated;
}

TEST(PricedModes, ASideThatIsPaidForIsChanged) {
  mpcc::PolynomialProblem problem(off_one_axis());
  adapters::IpoptSolver ipopt;
  adapters::HighsLpcc highs;
  SolveOptions options;
  options.first = FirstProblem::modes;
  const auto solution = solve(problem, ipopt, highs, options, Start{.w = {0.0, 1.0}, .multipliers = {}});
  ASSERT_TRUE(solution);
  EXPECT_EQ(solution->termination, result::Termination::completed) << solution->message;
  EXPECT_NEAR(solution->w[0], 1.0, 1e-8);
  EXPECT_NEAR(solution->w[1], 0.0, 1e-8);
  for (const auto& step : solution->homotopy) EXPECT_NE(step.message, "begins at the start");
  EXPECT_TRUE(solution->homotopy.front().message.starts_with("modes with a price of"));
}

TEST(PricedModes, OnlySidesThatAreZeroAndPaidForAreFreed) {
  mpcc::PolynomialProblem problem(off_one_axis());
  const std::vector<ActiveSide> sides{ActiveSide::G};
  EXPECT_EQ(problem.freed(sides, linalg::Vector{0.5, 0.0}, 0.1), std::vector<ActiveSide>{ActiveSide::H});
  EXPECT_EQ(problem.freed(sides, linalg::Vector{0.05, 7.0}, 0.1), sides);
}

/// f + 3 w0 with w0 the side that is zero.
TEST(PricedModes, ThePriceIsThatOfZeroSidesOnly) {
  mpcc::PolynomialProblem problem(off_one_axis());
  crossover::PricedSides priced(problem, {ActiveSide::G}, 3.0);
  const linalg::Vector w{0.5, 2.0};
  EXPECT_DOUBLE_EQ(priced.objective(w), problem.objective(w) + 1.5);
  linalg::Vector slope(2), own(2);
  priced.objective_gradient(w, slope);
  problem.objective_gradient(w, own);
  EXPECT_DOUBLE_EQ(slope[0], own[0] + 3.0);
  EXPECT_DOUBLE_EQ(slope[1], own[1]);
  EXPECT_EQ(priced.pairs(), 0);
}

}  // namespace
}  // namespace saltus::solver
