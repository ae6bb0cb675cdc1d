#include "saltus/mpcc/residuals.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "derivative_check.hpp"
#include "polynomial_problem.hpp"

namespace saltus::mpcc {
namespace {

/// 0 <= w0 _|_ w1 >= 0, 0 <= w1 - 2 _|_ w2 >= 0, -1 <= w0 w1 + w2^3 <= 1, w <= 5.
PolynomialProblem two_pairs() {
  PolynomialStatement statement;
  statement.variables = 3;
  statement.f = {{{1.0, {2}}, {-1.0, {1, 1, 1}}}};
  statement.g = {{{{1.0, {1, 1}}, {1.0, {0, 0, 3}}}}};
  statement.g_bounds = {linalg::Vector::constant(1, -1.0), linalg::Vector::constant(1, 1.0)};
  statement.G = {{{{1.0, {1}}}}, {{{1.0, {0, 1}}, {-2.0, {}}}}};
  statement.H = {{{{1.0, {0, 1}}}}, {{{1.0, {0, 0, 1}}}}};
  statement.w_bounds = {linalg::Vector::constant(3, -std::numeric_limits<double>::infinity()),
                        linalg::Vector::constant(3, 5.0)};
  return PolynomialProblem(statement);
}

TEST(MpccResiduals, FeasiblePoint) {
  auto problem = two_pairs();
  const Residuals at = residuals(problem, linalg::Vector{0.0, 3.0, 0.0});
  EXPECT_EQ(at.primal_infeasibility, 0.0);
  EXPECT_EQ(at.complementarity_residual, 0.0);
  EXPECT_EQ(at.complementarity_product, 0.0);
}

TEST(MpccResiduals, EachKindOfViolation) {
  auto problem = two_pairs();
  // Pairs (0.5, 4) and (2, 0.25); g = 2 + 1/64 exceeds 1.
  const Residuals inside = residuals(problem, linalg::Vector{0.5, 4.0, 0.25});
  EXPECT_DOUBLE_EQ(inside.complementarity_residual, 0.5);
  EXPECT_DOUBLE_EQ(inside.complementarity_product, 2.0);
  EXPECT_DOUBLE_EQ(inside.primal_infeasibility, 1.0 + 1.0 / 64.0);
  EXPECT_DOUBLE_EQ(residuals(problem, linalg::Vector{0.0, 7.0, 0.0}).primal_infeasibility, 2.0);   // bound of w
  EXPECT_DOUBLE_EQ(residuals(problem, linalg::Vector{0.0, 0.5, 0.0}).primal_infeasibility, 1.5);   // G_2 < 0
  EXPECT_DOUBLE_EQ(residuals(problem, linalg::Vector{0.0, 2.5, -0.5}).primal_infeasibility, 0.5);  // H_2 < 0
}

TEST(MpccResiduals, UndefinedPointIsNotFeasible) {
  auto problem = two_pairs();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(std::isnan(residuals(problem, linalg::Vector{nan, 3.0, 0.0}).infeasibility()));
}

TEST(MpccResiduals, ActiveSides) {
  auto problem = two_pairs();
  using enum ActiveSide;
  EXPECT_EQ(active_sides(problem, linalg::Vector{1e-9, 2.0, 0.0}, 1e-8), (std::vector{G, biactive}));
  EXPECT_EQ(active_sides(problem, linalg::Vector{1e-9, 3.0, 0.0}, 1e-10), (std::vector{none, H}));
}

TEST(PolynomialProblem, Derivatives) {
  auto problem = two_pairs();
  expect_correct_derivatives(problem, linalg::Vector{0.3, -0.7, 1.1});
}

}  // namespace
}  // namespace saltus::mpcc
