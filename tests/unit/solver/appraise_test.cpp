// What the certificate says of constraints, multipliers and second derivatives, on problems where that is known.
#include <gtest/gtest.h>

#include "saltus/adapters/highs/highs_lpcc.hpp"
#include "saltus/adapters/ipopt/ipopt_solver.hpp"
#include "saltus/solver/run_internal.hpp"
#include "small_problems.hpp"

namespace saltus::solver {
namespace {

using enum mpcc::ActiveSide;

/// Solves the branch of these sides, and appraises it.
Solution appraised(const mpcc::PolynomialStatement& statement, const std::vector<mpcc::ActiveSide>& sides,
                   const linalg::Vector& from) {
  mpcc::PolynomialProblem problem(statement);
  adapters::IpoptSolver ipopt;
  adapters::HighsLpcc highs;
  const SolveOptions options;
  Run run(problem, ipopt, highs, options);
  run.branch = run.solve_branch(sides, from, 500);
  descend(run);
  appraise(run);
  run.solution.w = run.branch->w;
  return run.solution;
}

/// min (w0 - 1)^2 with rows and bounds to be added.
mpcc::PolynomialStatement square() { return small::statement(1, 0, {{{1.0, {2}}, {-2.0, {1}}, {1.0, {}}}}); }

TEST(Appraise, KnowsARegularOptimum) {
  const Solution solution = appraised(small::minimum_on_one_axis(), {H}, {0.5, 0.0});
  const auto& of = solution.certificate;
  EXPECT_EQ(of.licq, true);
  EXPECT_EQ(of.dependent_rows, 0);
  EXPECT_TRUE(of.dependent.empty());
  EXPECT_EQ(of.unique_multipliers, true);
  EXPECT_EQ(of.strict_complementarity, true);
  EXPECT_EQ(of.ulsc, true);
  EXPECT_EQ(of.sosc, true);
}

TEST(Appraise, FourActiveConstraintsInThreeVariablesDepend) {
  const Solution solution = appraised(small::b_not_strong(), {G}, {0.0, 0.5, 0.0});
  EXPECT_EQ(solution.certificate.licq, false);
  EXPECT_EQ(solution.certificate.dependent_rows, 1);
  EXPECT_EQ(solution.certificate.dependent.size(), 4U);
  EXPECT_EQ(solution.certificate.unique_multipliers, false);
  EXPECT_EQ(solution.certificate.sosc, true) << "no direction is left";
}

TEST(Appraise, TwoEqualRowsShareTheirMultiplier) {
  auto statement = square();
  for (int row = 0; row < 2; ++row) small::add_row(statement, small::variable(0), 2.0, small::infinity);
  small::add_row(statement, {{{1.0, {1}}, {-7.0, {}}}}, -small::infinity, 0.0);
  const Solution solution = appraised(statement, {}, {3.0});
  ASSERT_TRUE(solution.multiplier_set);
  EXPECT_EQ(solution.certificate.licq, false);
  EXPECT_EQ(solution.certificate.dependent, (std::vector<std::string>{"g[0]", "g[1]"}));
  adapters::HighsLpcc highs;
  for (const int row : {0, 1}) {
    const auto range = solution.multiplier_set->of_row(row, highs);
    EXPECT_FALSE(range.is_unique());
    EXPECT_NEAR(range.lower, -2.0, 1e-7);
    EXPECT_NEAR(range.upper, 0.0, 1e-7);
  }
  EXPECT_TRUE(solution.multiplier_set->of_row(2, highs).is_unique()) << "it is not active";
}

// As a terminal constraint on a surface: the branch ends where the constraint holds, so it can only move to one side.
TEST(Appraise, ARowThatABoundHoldsTooHasNoLimitOnOneSide) {
  auto statement = square();
  statement.w_bounds.upper[0] = 2.0;
  small::add_row(statement, small::variable(0), 2.0, 2.0);
  const Solution solution = appraised(statement, {}, {1.0});
  ASSERT_TRUE(solution.multiplier_set);
  adapters::HighsLpcc highs;
  const auto of_row = solution.multiplier_set->of_row(0, highs);
  EXPECT_EQ(of_row.lower, -small::infinity);
  EXPECT_NEAR(of_row.upper, -2.0, 1e-7) << "the objective rises by 2 per unit of the bound below";
  const auto of_bound = solution.multiplier_set->of_bounds(0, highs);
  EXPECT_NEAR(of_bound.lower, 0.0, 1e-7);
  EXPECT_EQ(of_bound.upper, small::infinity);
}

TEST(Appraise, AMultiplierIsUniqueThoughOthersAreNot) {
  // (w0 - 1)^2 + (w1 - 1)^2 with w0 >= 2 twice, w1 >= 3 once.
  auto statement = small::statement(2, 0, {{{1.0, {2}}, {-2.0, {1}}, {1.0, {0, 2}}, {-2.0, {0, 1}}, {2.0, {}}}});
  for (int row = 0; row < 2; ++row) small::add_row(statement, small::variable(0), 2.0, small::infinity);
  small::add_row(statement, small::variable(1), 3.0, small::infinity);
  const Solution solution = appraised(statement, {}, {3.0, 4.0});
  ASSERT_TRUE(solution.multiplier_set);
  EXPECT_EQ(solution.multiplier_set->dependent_rows(), 1);
  adapters::HighsLpcc highs;
  const auto range = solution.multiplier_set->of_row(2, highs);
  EXPECT_TRUE(range.is_unique());
  EXPECT_NEAR(range.lower, -4.0, 1e-7);
}

TEST(Appraise, ASaddleIsNotSecondOrderSufficient) {
  // (w0 - 1)^2 - w2^2 at w2 = 0, with the pair at (1, 0).
  const auto statement = small::statement(3, 1, {{{1.0, {2}}, {-2.0, {1}}, {1.0, {0, 1}}, {-1.0, {0, 0, 2}}}});
  const Solution solution = appraised(statement, {H}, {1.0, 0.0, 0.0});
  ASSERT_EQ(solution.w[2], 0.0);
  EXPECT_EQ(solution.certificate.sosc, false);
  EXPECT_EQ(solution.certificate.licq, true);
}

TEST(Appraise, AFlatDirectionDecidesNothing) {
  const auto statement = small::statement(3, 1, {{{1.0, {2}}, {-2.0, {1}}, {1.0, {0, 1}}}});
  const Solution solution = appraised(statement, {H}, {1.0, 0.0, 0.0});
  EXPECT_EQ(solution.certificate.sosc, std::nullopt);
}

TEST(Appraise, AnActiveBoundWithoutMultiplierIsNotStrict) {
  auto statement = square();
  statement.w_bounds.lower[0] = 1.0;
  const Solution solution = appraised(statement, {}, {1.0});
  EXPECT_EQ(solution.certificate.strict_complementarity, false);
  EXPECT_EQ(solution.certificate.sosc, true);
}

TEST(Appraise, ABiactivePairWithAZeroMultiplierIsNotStrict) {
  // w0^2 + w1 at the origin: nu = (0, 1).
  const auto statement = small::statement(2, 1, {{{1.0, {2}}, {1.0, {0, 1}}}});
  const Solution solution = appraised(statement, {H}, {1.0, 0.0});
  EXPECT_EQ(solution.certificate.biactive, 1);
  EXPECT_EQ(solution.certificate.ulsc, false);
}

}  // namespace
}  // namespace saltus::solver
