#include "saltus/solver/homotopy/relaxation.hpp"

#include <cmath>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "../mpcc/counting_problem.hpp"
#include "../mpcc/derivative_check.hpp"
#include "../mpcc/polynomial_problem.hpp"
#include "saltus/solver/homotopy/relaxed_problem.hpp"
#include "small_problems.hpp"

namespace saltus::solver::homotopy {
namespace {

class EveryRelaxation : public testing::TestWithParam<Relaxation> {};

TEST_P(EveryRelaxation, Derivatives) {
  const double sigma = 0.04;
  const double step = 1e-5;
  for (int which = 0; which < inequalities(GetParam()); ++which) {
    // No point lies within a step of a seam: a + b = 2 sigma of Kanzow-Schwartz, |a - b| = s of Steffensen-Ulbrich.
    for (const auto& [a, b] : {std::pair{0.1, 0.15}, {0.3, 0.15}, {1.0, 2.0}, {3.0, 0.01}, {0.0, 0.9}, {0.2, 0.21}}) {
      const auto at = [&, which](double x, double y) { return pair_function(GetParam(), which, x, y, sigma); };
      const PairFunction phi = at(a, b);
      const auto slope = [&](double PairFunction::*of, double in_a, double in_b) {
        return (at(a + in_a * step, b + in_b * step).*of - at(a - in_a * step, b - in_b * step).*of) / (2.0 * step);
      };
      // Third derivatives are at most of order 1/s^2 = 25 here: the error of a difference is below 25 step^2.
      const double tolerance = 1e-8;
      EXPECT_NEAR(phi.a, slope(&PairFunction::value, 1, 0), tolerance);
      EXPECT_NEAR(phi.b, slope(&PairFunction::value, 0, 1), tolerance);
      EXPECT_NEAR(phi.aa, slope(&PairFunction::a, 1, 0), tolerance) << a << " " << b;
      EXPECT_NEAR(phi.ab, slope(&PairFunction::a, 0, 1), tolerance) << a << " " << b;
      EXPECT_NEAR(phi.ab, slope(&PairFunction::b, 1, 0), tolerance) << a << " " << b;
      EXPECT_NEAR(phi.bb, slope(&PairFunction::b, 0, 1), tolerance) << a << " " << b;
      const auto slope_in_sigma = [&](double PairFunction::*of) {
        const double change = 1e-6;
        const auto in = [&](double parameter) { return pair_function(GetParam(), which, a, b, parameter); };
        return (in(sigma + change).*of - in(sigma - change).*of) / (2.0 * change);
      };
      // Third derivatives with respect to sigma are at most of order 1/sigma^(5/2) = 3e3, times change^2, and rounding;
      // that of phi.s of order 60 phi.ss / sigma^2: 6e-9 phi.ss.
      EXPECT_NEAR(phi.s, slope_in_sigma(&PairFunction::value), tolerance) << a << " " << b;
      EXPECT_NEAR(phi.as, slope_in_sigma(&PairFunction::a), tolerance) << a << " " << b;
      EXPECT_NEAR(phi.bs, slope_in_sigma(&PairFunction::b), tolerance) << a << " " << b;
      EXPECT_NEAR(phi.ss, slope_in_sigma(&PairFunction::s), tolerance * (2.0 + std::abs(phi.ss))) << a << " " << b;
      if (is_bilinear(GetParam())) {
        EXPECT_EQ(phi.aa, 0.0);
        EXPECT_EQ(phi.bb, 0.0);
      }
    }
  }
}

/// Whether (a, b) belongs to the relaxed set.
bool contains(Relaxation relaxation, double a, double b, double sigma, double slack) {
  const double bound = lower_bound(relaxation, sigma);
  bool inside = a >= bound && b >= bound;
  for (int which = 0; which < inequalities(relaxation); ++which) {
    inside = inside && pair_function(relaxation, which, a, b, sigma).value <= slack;
  }
  return inside;
}

TEST_P(EveryRelaxation, ShrinksToTheComplementaryPoints) {
  for (const double sigma : {1.0, 1e-2, 1e-6, 1e-10}) {
    const double s = std::sqrt(sigma);
    // All complementary points but those near the corner belong to it ...
    for (const double value : {6.0 * s, 1.0 + 6.0 * s, 1e3}) {
      EXPECT_TRUE(contains(GetParam(), value, 0.0, sigma, 1e-12 * value)) << sigma << " " << value;
      EXPECT_TRUE(contains(GetParam(), 0.0, value, sigma, 1e-12 * value)) << sigma << " " << value;
    }
    // ... no point does that is away from the axes, and next to a side of order 1 the other is at most of order sigma.
    EXPECT_FALSE(contains(GetParam(), 1.01 * s, 1.01 * s, sigma, 0.0)) << sigma;
    EXPECT_FALSE(contains(GetParam(), 4.0 * s, 4.0 * s, sigma, 0.0)) << sigma;
    EXPECT_FALSE(contains(GetParam(), 2.0, 2.0 * sigma, sigma, 0.0)) << sigma;
    EXPECT_FALSE(contains(GetParam(), 2.0 * sigma, 2.0, sigma, 0.0)) << sigma;
  }
}

TEST_P(EveryRelaxation, RelaxedProblemHasExactDerivatives) {
  // Sides share variables with each other and with themselves, so that outer products meet on diagonal entries.
  mpcc::PolynomialStatement statement;
  statement.variables = 3;
  statement.f = {{{1.0, {2, 1}}}};
  statement.g = {{{{1.0, {1, 1, 1}}}}};
  statement.g_bounds = {linalg::Vector::zero(1), linalg::Vector::zero(1)};
  statement.G = {{{{1.0, {1}}, {0.5, {0, 0, 2}}}}, {{{1.0, {0, 1}}}}};
  statement.H = {{{{1.0, {1, 1}}}}, {{{1.0, {0, 0, 1}}, {0.3, {0, 1}}}}};
  mpcc::PolynomialProblem problem(statement);
  problem.set_sign(1, mpcc::Sign::implied);
  for (const Steering steering : all_steerings) {
    RelaxedProblem relaxed(problem, GetParam(), steering);
    relaxed.set_sigma(0.09);
    EXPECT_EQ(relaxed.constraints(), 1 + 3 + 2 * inequalities(GetParam()));
    EXPECT_EQ(relaxed.pairs(), 0);
    linalg::Vector w = relaxed.with_elastic_variables(linalg::Vector{0.7, 0.9, 0.4});
    ASSERT_EQ(w.size(), 3 + (steering == Steering::direct ? 0 : steering == Steering::l1 ? 2 : 1));
    for (linalg::Index i = 3; i < w.size(); ++i) w[i] = 0.09 + 0.02 * static_cast<double>(i);  // off all seams
    mpcc::expect_correct_derivatives(relaxed, w);
  }
}

TEST(RelaxedProblem, OneEvaluationPerPoint) {
  mpcc::PolynomialProblem inner(small::b_not_strong());
  mpcc::CountingProblem problem(inner);
  for (const Steering steering : all_steerings) {
    RelaxedProblem relaxed(problem, Relaxation::fischer_burmeister, steering);
    relaxed.set_sigma(0.1);
    problem.forget_counts();
    linalg::Vector w = linalg::Vector::constant(relaxed.variables(), 0.3);
    linalg::Vector c(relaxed.constraints());
    linalg::Vector jacobian(relaxed.jacobian_pattern().entries());
    linalg::Vector hessian(relaxed.hessian_pattern().entries());
    for (int point = 1; point <= 3; ++point) {
      w[0] += 0.1;
      relaxed.functions(w, c);
      relaxed.jacobian(w, jacobian);
      relaxed.hessian(w, 1.0, c, hessian);
      relaxed.functions(w, c);
      relaxed.jacobian(w, jacobian);
      EXPECT_EQ(problem.functions_count(), point);
      EXPECT_EQ(problem.jacobian_count(), point);
      EXPECT_EQ(problem.hessian_count(), point);
    }
  }
}

TEST(Relaxation, NamesAreDistinct) {
  std::set<std::string_view> names;
  for (const Relaxation relaxation : all_relaxations) names.insert(name(relaxation));
  EXPECT_EQ(names.size(), all_relaxations.size());
}

TEST(Relaxation, NcpFunctionsKeepTheirDigitsNearTheAxes) {
  // a + b - sqrt(a^2 + b^2 + 2 sigma) = (2 a b - 2 sigma) / (a + b + sqrt(...)) = -1e-10 + O(1e-20) at (1, 0).
  const double value = pair_function(Relaxation::fischer_burmeister, 0, 1.0, 0.0, 1e-10).value;
  EXPECT_NEAR(value, -1e-10, 1e-19);
}

INSTANTIATE_TEST_SUITE_P(All, EveryRelaxation, testing::ValuesIn(all_relaxations),
                         [](const auto& test) { return std::string(name(test.param)); });

}  // namespace
}  // namespace saltus::solver::homotopy
