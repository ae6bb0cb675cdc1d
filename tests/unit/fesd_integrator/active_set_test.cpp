// What needs no model: active sets, small linear systems, polynomials of elements.
#include "saltus/fesd_integrator/element/active_set.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "saltus/fesd_integrator/element/dense_system_internal.hpp"
#include "saltus/fesd_integrator/element/element.hpp"
#include "saltus/fesd_integrator/element/element_polynomial_internal.hpp"

namespace saltus::fesd_integrator {
namespace {

using discretization::TableauFamily;
using Kind = Condition::Kind;

bool operator==(const Condition& a, const Condition& b) { return a.kind == b.kind && a.selection == b.selection; }

TEST(ActiveSet, StepSelectionsAreFixedOrSlide) {
  const std::array parts{Part{false, 0, 3}};
  const ActiveSet set(parts, {1, 0, -1});
  ASSERT_EQ(set.sliding().size(), 1U);
  EXPECT_EQ(set.sliding()[0].selection, 1);
  EXPECT_EQ(set.sliding()[0].reference, -1);
  std::vector<double> all(3);
  const double unknown = 0.3;
  set.selections(&unknown, all.data());
  EXPECT_EQ(all, (std::vector{1.0, 0.3, 0.0}));
  double back = 0.0;
  set.unknowns(all.data(), &back);
  EXPECT_EQ(back, unknown);
  const std::vector<double> psi{5.0, 7.0, -2.0};
  EXPECT_EQ(set.surface(0, psi.data()), 7.0);
  const std::vector<Condition> expected{{Kind::side, 0}, {Kind::lower, 1}, {Kind::upper, 1}, {Kind::side, 2}};
  const std::vector<double> values{5.0, 0.3, 0.7, 2.0};
  ASSERT_EQ(set.conditions().size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_TRUE(set.conditions()[i] == expected[i]) << i;
    EXPECT_DOUBLE_EQ(set.value(expected[i], psi.data(), all.data()), values[i]) << i;
  }
}

TEST(ActiveSet, RegionsOfASimplexShareTheWeightOne) {
  const std::array parts{Part{true, 0, 3}};
  const ActiveSet set(parts, {0, -1, 0});
  ASSERT_EQ(set.sliding().size(), 1U);
  EXPECT_EQ(set.sliding()[0].selection, 2);
  EXPECT_EQ(set.sliding()[0].reference, 0);
  std::vector<double> all(3);
  const double unknown = 0.3;
  set.selections(&unknown, all.data());
  EXPECT_EQ(all, (std::vector{0.7, 0.0, 0.3}));
  const std::vector<double> g{1.0, 4.0, 1.5};
  EXPECT_EQ(set.surface(0, g.data()), -0.5);
  // The inactive region's indicator is above those of the active ones; both weights stay above 0, and below 1 by that.
  const std::vector<Condition> expected{{Kind::lower, 0}, {Kind::side, 1}, {Kind::lower, 2}};
  ASSERT_EQ(set.conditions().size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_TRUE(set.conditions()[i] == expected[i]) << i;
  EXPECT_EQ(set.side(1, g.data()), 3.0);
  // Alone its weight is 1 and nothing can end it but another region.
  const ActiveSet alone(parts, {-1, 0, -1});
  EXPECT_TRUE(alone.sliding().empty());
  EXPECT_EQ(alone.conditions().size(), 2U);
}

TEST(DenseSystem, SolvesToRoundingAndByLeastNorm) {
  DenseSystem system;
  system.reserve(2);
  system.reset(2);
  system.matrix() = linalg::Matrix{{0.0, 2.0}, {4.0, 1.0}};
  system.right() = {6.0, 7.0};
  ASSERT_TRUE(system.solve(1e-14));
  EXPECT_DOUBLE_EQ(system.right()(0), 1.0);
  EXPECT_DOUBLE_EQ(system.right()(1), 3.0);
  // x + y = 2 twice: (1, 1) is nearest to the origin.
  system.reset(2);
  system.matrix().set_constant(1.0);
  system.right().set_constant(2.0);
  ASSERT_TRUE(system.solve(1e-14));
  EXPECT_NEAR(system.right()(0), 1.0, 1e-14);
  EXPECT_NEAR(system.right()(1), 1.0, 1e-14);
  // x + y = 2 and x + y = 3 is no rounding.
  system.reset(2);
  system.matrix().set_constant(1.0);
  system.right() = {2.0, 3.0};
  EXPECT_FALSE(system.solve(1e-14));
  system.reset(1);
  system.matrix()(0, 0) = std::numeric_limits<double>::quiet_NaN();
  system.right()(0) = 1.0;
  EXPECT_FALSE(system.solve(1e-14));
}

/// An element from 2 to 2.5 of x(t) whose slopes at the stages are those of x.
template <class Curve, class Slope>
Element element_of(const discretization::ButcherTableau& method, Curve x, Slope slope) {
  Element element;
  element.t = 2.0;
  element.h = 0.5;
  element.x = {x(2.0)};
  element.end = {x(2.5)};
  for (linalg::Index m = 0; m < method.stages(); ++m) {
    const double t = 2.0 + 0.5 * method.c(m);
    element.stage_states.push_back(x(t));
    element.stage_slopes.push_back(slope(t));
  }
  return element;
}

TEST(ElementPolynomial, IsExactForPolynomialsOfItsDegree) {
  const auto x = [](double t) { return t * t * t - 2.0 * t; };
  const auto slope = [](double t) { return 3.0 * t * t - 2.0; };
  for (const auto& [family, stages] : {std::pair{TableauFamily::radau_iia, 3},
                                       {TableauFamily::gauss_legendre, 3},
                                       {TableauFamily::lobatto_iiia, 4},
                                       {TableauFamily::lobatto_iiic, 3},
                                       {TableauFamily::explicit_rk, 4}}) {
    const auto method = *discretization::butcher_tableau(family, stages);
    const ElementPolynomial polynomial(method);
    const Element element = element_of(method, x, slope);
    for (const double theta : {0.0, 0.1, 0.5, 0.77, 1.0}) {
      double value = 0.0;
      polynomial.evaluate(element, theta, &value);
      EXPECT_NEAR(value, x(2.0 + 0.5 * theta), 1e-13) << name(family) << " " << theta;
    }
    const auto& points = polynomial.watch_points();
    EXPECT_TRUE(std::is_sorted(points.begin(), points.end()));
    EXPECT_EQ(points.front(), 0.0);
    EXPECT_EQ(points.back(), 1.0);
    EXPECT_GE(points.size(), 3U);
    for (std::size_t i = 0; i < points.size(); ++i) {
      double value = 0.0;
      polynomial.watch_state(element, i, &value);
      EXPECT_NEAR(value, x(2.0 + 0.5 * points[i]), 1e-13) << name(family) << " " << points[i];
    }
  }
}

}  // namespace
}  // namespace saltus::fesd_integrator
