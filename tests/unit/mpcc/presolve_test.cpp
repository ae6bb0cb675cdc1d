// What bounds alone decide, on problems where it can be seen.
#include "saltus/mpcc/presolve.hpp"

#include <gtest/gtest.h>

#include "polynomial_problem.hpp"

namespace saltus::mpcc {
namespace {

constexpr double no_bound = std::numeric_limits<double>::infinity();

/// Rows g = w0 + w1 in [-1, 1], an empty one, w2 without a bound; pairs (w0, w1), (w1, w2).
PolynomialProblem sample() {
  PolynomialStatement statement;
  statement.variables = 3;
  statement.f = {{{1.0, {2}}, {1.0, {0, 2}}, {1.0, {0, 0, 2}}}};
  const Polynomial w0{{{1.0, {1}}}}, w1{{{1.0, {0, 1}}}}, w2{{{1.0, {0, 0, 1}}}};
  statement.g = {{{{1.0, {1}}, {1.0, {0, 1}}}}, w2};
  statement.g_bounds = {{-1.0, -no_bound}, {1.0, no_bound}};
  statement.G = {w0, w1};
  statement.H = {w1, w2};
  statement.w_bounds = {{0.5, 0.0, 0.0}, {4.0, 4.0, 4.0}};
  return PolynomialProblem(statement);
}

/// Of rows g0, g1, G0, G1, H0, H1 within those bounds.
Bounds ranges() { return {{0.5, 0.0, 0.5, 0.0, 0.0, 0.0}, {8.0, 4.0, 4.0, 4.0, 4.0, 4.0}}; }

TEST(Presolve, CountsWhatItFinds) {
  const auto problem = sample();
  const Presolve found = presolve(problem, ranges());
  EXPECT_EQ(found.fixed_variables, 0);
  EXPECT_EQ(found.empty_rows, 1) << "w2 without a bound";
  EXPECT_EQ(found.kept_rows, std::vector{0});
  EXPECT_EQ(found.forced_pairs, 1) << "w0 >= 0.5 makes w1 zero";
  EXPECT_EQ(found.zero_sides, std::vector{4});
  EXPECT_EQ(found.kept_pairs, std::vector{1});
  EXPECT_TRUE(found.infeasible.empty());
}

TEST(Presolve, NamesRowsThatContradictBounds) {
  const auto problem = sample();
  auto far = ranges();
  far.lower[0] = 2.0;   // g0 is to be at most 1
  far.lower[4] = 0.25;  // H0 positive as G0 is
  const auto found = presolve(problem, far).infeasible;
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0], "g[0]: 2 to 8 within the bounds of the variables, but -1 to 1 is asked for");
  EXPECT_EQ(found[1],
            "G[0] and H[0]: both are positive within the bounds of the variables and of rows of one variable");
}

// Files of discretised systems have sides like lambda + 5e-9: rounding of what they were made of.
TEST(Presolve, ASideThatIsHardlyPositiveForcesNothing) {
  const auto problem = sample();
  auto near = ranges();
  near.lower[2] = 5e-9;
  EXPECT_EQ(presolve(problem, near).forced_pairs, 0);
}

TEST(Presolve, ASideThatIsAlwaysZeroLeavesASign) {
  const auto problem = sample();
  auto fixed = ranges();
  fixed.upper[3] = 0.0;
  const Presolve found = presolve(problem, fixed);
  EXPECT_EQ(found.fixed_pairs, 1);
  EXPECT_EQ(found.positive_sides, std::vector{5});
}

TEST(PresolvedProblem, HasTheFunctionsOfWhatIsLeft) {
  auto problem = sample();
  PresolvedProblem smaller(problem, presolve(problem, ranges()));
  ASSERT_EQ(smaller.constraints(), 2);
  ASSERT_EQ(smaller.pairs(), 1);
  linalg::Vector c(smaller.rows());
  smaller.functions(linalg::Vector{1.0, 2.0, 3.0}, c);
  EXPECT_EQ(c, (linalg::Vector{3.0, 2.0, 2.0, 3.0}));
  EXPECT_EQ(smaller.constraint_bounds().lower, (linalg::Vector{-1.0, 0.0}));
  EXPECT_EQ(smaller.constraint_bounds().upper, (linalg::Vector{1.0, 0.0}));
  EXPECT_EQ(smaller.row_name(1), "H[0]");
  EXPECT_EQ(smaller.row_name(3), "H[1]");
  linalg::Vector entries(smaller.jacobian_pattern().entries());
  smaller.jacobian(linalg::Vector{1.0, 2.0, 3.0}, entries);
  double sum = 0.0;
  for (linalg::Index e = 0; e < entries.size(); ++e) {
    if (smaller.jacobian_pattern().row[static_cast<std::size_t>(e)] == 0) sum += entries[e];
  }
  EXPECT_EQ(sum, 2.0);
}

TEST(PresolvedProblem, ImpliedSidesThatAreZeroFixTheirVariables) {
  auto problem = sample();
  problem.set_sign(2, Sign::implied);  // H0 = w1 - 0
  const PresolvedProblem smaller(problem, presolve(problem, ranges()));
  EXPECT_EQ(smaller.constraints(), 1);
  EXPECT_EQ(smaller.variable_bounds().upper[1], 0.0);
  EXPECT_EQ(smaller.variable_bounds().lower[1], 0.0);
}

}  // namespace
}  // namespace saltus::mpcc
