#include "saltus/solver/active_set/polish.hpp"

#include <gtest/gtest.h>

#include "../mpcc/polynomial_problem.hpp"

namespace saltus::solver::active_set {
namespace {

/// w0^2 + w1^2 + w2 = 2, 0 <= w0 _|_ w1 >= 0, w2 = w0 w1 + 1: (1, 0, 1) and (0, 1, 1), and nothing with both sides
/// zero.
mpcc::PolynomialProblem circle_on_axes() {
  mpcc::PolynomialStatement statement;
  statement.variables = 3;
  statement.g = {{{{1.0, {2}}, {1.0, {0, 2}}, {1.0, {0, 0, 1}}, {-2.0, {}}}},
                 {{{1.0, {0, 0, 1}}, {-1.0, {1, 1}}, {-1.0, {}}}}};
  statement.g_bounds = {linalg::Vector::zero(2), linalg::Vector::zero(2)};
  statement.G = {{{{1.0, {1}}}}};
  statement.H = {{{{1.0, {0, 1}}}}};
  return mpcc::PolynomialProblem(statement);
}

TEST(Polish, NewtonToRounding) {
  auto problem = circle_on_axes();
  linalg::Vector w{1.01, 1e-5, 0.98};
  EXPECT_EQ(polish(problem, w), PolishOutcome::polished);
  EXPECT_NEAR((w - linalg::Vector{1.0, 0.0, 1.0}).norm(), 0.0, 1e-14);
}

TEST(Polish, LeavesThePointAloneWhereItFails) {
  auto problem = circle_on_axes();
  const linalg::Vector middle{0.7, 0.7, 1.0};
  linalg::Vector w = middle;
  EXPECT_EQ(polish(problem, w), PolishOutcome::no_active_set);
  EXPECT_EQ(w, middle);
  // Newton with w1 = 0 goes to w0 = -1 from here: a solution of the equations that violates a sign.
  const linalg::Vector beyond{-0.9, 1e-6, 1.0};
  w = beyond;
  EXPECT_EQ(polish(problem, w), PolishOutcome::violated);
  EXPECT_EQ(w, beyond);
}

TEST(Polish, SumsOfNonnegativeTermsVanishTermByTerm) {
  // 0 <= w0 + w1 _|_ w2 >= 0 with w >= 0 and w2 = 1 + w0 - w1: with the sum alone zero, w0 = -w1 would do, too.
  mpcc::PolynomialStatement statement;
  statement.variables = 3;
  statement.g = {{{{1.0, {0, 0, 1}}, {-1.0, {1}}, {1.0, {0, 1}}, {-1.0, {}}}}};
  statement.g_bounds = {linalg::Vector::zero(1), linalg::Vector::zero(1)};
  statement.G = {{{{1.0, {1}}, {1.0, {0, 1}}}}};
  statement.H = {{{{1.0, {0, 0, 1}}}}};
  statement.w_bounds = {linalg::Vector::zero(3), linalg::Vector::constant(3, 10.0)};
  mpcc::PolynomialProblem problem(statement);
  problem.set_sign(0, mpcc::Sign::implied);
  problem.set_sign(1, mpcc::Sign::implied);
  linalg::Vector w{3e-6, 1e-6, 1.0};
  EXPECT_EQ(polish(problem, w), PolishOutcome::polished);
  EXPECT_NEAR((w - linalg::Vector{0.0, 0.0, 1.0}).norm(), 0.0, 1e-14);
}

}  // namespace
}  // namespace saltus::solver::active_set
