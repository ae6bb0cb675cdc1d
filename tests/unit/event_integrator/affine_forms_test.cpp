#include "saltus/event_integrator/search/affine_forms.hpp"

#include <algorithm>
#include <limits>

#include <gtest/gtest.h>

namespace saltus::event_integrator {
namespace {

/// x1 - 1, x1 - 3, 2 - x1, x2 - x1, t - 5, and a function that is not affine.
evaluation::AffineRows rows() {
  evaluation::AffineRows rows;
  rows.start = {0, 1, 2, 3, 5, 5, 5};
  rows.column = {0, 0, 0, 0, 1};
  rows.coefficient = {1.0, 1.0, -1.0, -1.0, 1.0};
  rows.rate = {0.0, 0.0, 0.0, 0.0, 1.0, 0.0};
  rows.offset = {-1.0, -3.0, 2.0, 0.0, -5.0, std::numeric_limits<double>::quiet_NaN()};
  return rows;
}

class Forms : public ::testing::Test {
 protected:
  Forms() : forms(2) {
    forms.load(rows());
    forms.reset(6);
    for (std::size_t i = 0; i < 6; ++i) forms.use_row(i, i);
    forms.group();
  }

  std::vector<std::size_t> suspects(double begin, double end, std::vector<double> low, std::vector<double> high) {
    const StepBounds bounds{begin, end, low.data(), high.data()};
    std::vector<std::size_t> found;
    forms.append_suspects(bounds, found);
    std::sort(found.begin(), found.end());
    EXPECT_EQ(forms.may_vanish(bounds), !found.empty());
    return found;
  }

  AffineForms forms;
};

using Indices = std::vector<std::size_t>;

TEST_F(Forms, EvaluateTheirRows) {
  const double x[] = {1.5, 4.0};
  const double expected[] = {0.5, -1.5, 0.5, 2.5, -4.0};
  for (std::size_t i = 0; i < 5; ++i) {
    ASSERT_TRUE(forms.has(i));
    EXPECT_EQ(forms.value(i, 1.0, x), expected[i]);
  }
  EXPECT_FALSE(forms.has(5));
}

TEST_F(Forms, TheirRatesAlongAFieldAreKnownWhereTheyAreMoreThanRounding) {
  const double f[] = {0.5, 4.0};
  const double expected[] = {0.5, 0.5, -0.5, 3.5, 1.0};
  for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(forms.rate_along(i, f), expected[i]);
  const double equal[] = {3.0, 3.0 * (1.0 + 4.0 * std::numeric_limits<double>::epsilon())};
  EXPECT_FALSE(forms.rate_along(3, equal));
  const double undefined[] = {std::numeric_limits<double>::quiet_NaN(), 1.0};
  EXPECT_FALSE(forms.rate_along(0, undefined));
}

TEST_F(Forms, ReplacedTheyAnswerByTheirNewRow) {
  const double x[] = {1.5, 4.0};
  evaluation::AffineRow row{{0, 1}, {2.0, 0.0}, 0.0, 1.0};  // fewer terms than the one before
  forms.replace(3, &row);
  EXPECT_EQ(forms.value(3, 1.0, x), 4.0);
  row = {{0, 1}, {2.0, 1.0}, 1.0, 1.0};
  forms.replace(3, &row);
  EXPECT_EQ(forms.value(3, 1.0, x), 9.0);
  forms.replace(5, &row);  // it had none
  EXPECT_EQ(forms.value(5, 1.0, x), 9.0);
  forms.watch(5, +1);
  EXPECT_EQ(suspects(0.0, 1.0, {-3.0, 0.5}, {1.0, 2.0}), Indices{5});
  forms.ignore(5);
  row.coefficient[1] = std::numeric_limits<double>::infinity();
  forms.replace(5, &row);
  EXPECT_FALSE(forms.has(5));
  forms.replace(3, nullptr);
  EXPECT_FALSE(forms.has(3));
}

TEST_F(Forms, LeaveTheirStartWhereNoMeanSlopeTurnsThemBack) {
  // Mean slopes of x1 between 1 and 2, of x2 between -1 and 1.
  const double low[] = {1.0, -1.0};
  const double high[] = {2.0, 1.0};
  const StepBounds slopes{0.0, 0.0, low, high};
  EXPECT_TRUE(forms.leaves(0, +1, slopes));
  EXPECT_FALSE(forms.leaves(0, -1, slopes));
  EXPECT_TRUE(forms.leaves(2, -1, slopes));   // 2 - x1
  EXPECT_FALSE(forms.leaves(3, -1, slopes));  // x2 - x1: between -3 and 0
  EXPECT_TRUE(forms.leaves(4, +1, slopes));   // t - 5
  const double lower_high[] = {2.0, 0.9};
  EXPECT_TRUE(forms.leaves(3, -1, {0.0, 0.0, low, lower_high}));
}

TEST_F(Forms, OnlyWhatIsWatchedAndReachedIsSuspect) {
  // x1 between 1 and 2, both thresholds hidden behind those at 3; x2 above x1; t before 5.
  forms.watch(0, +1);
  forms.watch(1, -1);
  forms.watch(2, +1);
  forms.watch(3, +1);
  forms.watch(4, -1);
  EXPECT_EQ(suspects(0, 1, {1.2, 3.5}, {1.8, 3.6}), Indices{});
  EXPECT_EQ(suspects(0, 1, {0.9, 3.5}, {1.8, 3.6}), (Indices{0}));
  EXPECT_EQ(suspects(0, 1, {1.2, 3.5}, {2.0, 3.6}), (Indices{2}));
  EXPECT_EQ(suspects(0, 1, {1.2, 4.5}, {3.5, 4.6}), (Indices{2}));  // the one at 3 lies behind that at 2
  EXPECT_EQ(suspects(0, 1, {1.2, 1.7}, {1.8, 3.6}), (Indices{3}));
  EXPECT_EQ(suspects(4.5, 5.0, {1.2, 3.5}, {1.8, 3.6}), (Indices{4}));
  forms.watch_none();
  EXPECT_EQ(suspects(0, 10, {-9, -9}, {9, 9}), Indices{});
}

TEST(Thresholds, BehindTheNearestOneNothingIsSuspectButWhatLiesBesideIt) {
  // Of one state: it lies above 0.5 (twice), 0.5 - 1e-15 and 0.1, and below 2, 2 + 1e-10 and 3.
  const std::vector<double> at{2.0, 0.1, 0.5, 3.0, 0.5 - 1e-15, 2.0 + 1e-10, 0.5};
  evaluation::AffineRows rows;
  rows.start = {0};
  for (const double value : at) {
    rows.start.push_back(rows.start.back() + 1);
    rows.column.push_back(0);
    rows.coefficient.push_back(2.0);
    rows.rate.push_back(0.0);
    rows.offset.push_back(-2.0 * value);
  }
  AffineForms forms(1);
  forms.load(rows);
  forms.reset(at.size());
  for (std::size_t i = 0; i < at.size(); ++i) forms.use_row(i, i);
  forms.group();
  for (std::size_t i = 0; i < at.size(); ++i) forms.watch(i, at[i] < 1.0 ? 1 : -1);
  const auto suspects = [&](double low, double high, double begin = 0.0, double end = 1.0) {
    std::vector<std::size_t> found;
    forms.append_suspects({begin, end, &low, &high}, found);
    std::sort(found.begin(), found.end());
    return found;
  };
  EXPECT_EQ(suspects(0.0, 1.5), (Indices{2, 4, 6}));
  EXPECT_EQ(suspects(1.0, 4.0), (Indices{0}));
  EXPECT_EQ(suspects(0.0, 4.0), (Indices{0, 2, 4, 6}));
  for (const std::size_t i : {2U, 4U, 6U}) forms.ignore(i);
  EXPECT_EQ(suspects(0.0, 4.0), (Indices{0, 1}));
  // A step from 1 to 1 + 1e-4 does not tell times apart that far.
  EXPECT_EQ(suspects(1.0, 4.0, 1.0, 1.0 + 1e-4), (Indices{0, 5}));
  forms.ignore(0);
  forms.watch(0, 1);  // crossed
  EXPECT_EQ(suspects(2.5, 2.6), (Indices{5}));
  EXPECT_EQ(suspects(1.5, 2.5), (Indices{0, 5}));
}

TEST_F(Forms, WhatIsIgnoredHidesNothing) {
  forms.watch(0, +1);
  forms.watch(1, -1);
  forms.watch(2, +1);
  forms.watch(3, +1);
  EXPECT_EQ(suspects(0, 1, {1.2, 3.5}, {2.0, 3.6}), (Indices{2}));
  forms.ignore(2);
  EXPECT_EQ(suspects(0, 1, {1.2, 3.5}, {2.0, 3.6}), Indices{});
  EXPECT_EQ(suspects(0, 1, {0.9, 3.5}, {3.1, 3.6}), (Indices{0, 1}));
  forms.ignore(0);
  EXPECT_EQ(suspects(0, 1, {-9.0, 3.5}, {2.9, 3.6}), Indices{});
  forms.watch(2, -1);  // the other side now
  EXPECT_EQ(suspects(0, 1, {1.9, 3.5}, {2.9, 3.6}), (Indices{2}));
  EXPECT_EQ(suspects(0, 1, {2.2, 1.0}, {2.9, 3.6}), (Indices{3}));
  forms.ignore(3);
  forms.ignore(3);
  EXPECT_EQ(suspects(0, 1, {2.2, 1.0}, {2.9, 3.6}), Indices{});
}

TEST_F(Forms, ThresholdsKnowTheirState) {
  EXPECT_TRUE(forms.is_threshold(2));
  EXPECT_EQ(forms.state(2), 0U);
  EXPECT_EQ(forms.factor(2), -1.0);
  for (const std::size_t i : {3U, 4U, 5U}) EXPECT_FALSE(forms.is_threshold(i));
}

TEST_F(Forms, AlongAStepAreTheirValues) {
  const auto f = [](double t, const double* x, double* xdot) {
    xdot[0] = x[1];
    xdot[1] = t - x[0];
  };
  const std::vector<double> x{1.2, -0.4};
  std::vector<double> slope(2);
  f(0.5, x.data(), slope.data());
  ode::Stepper stepper(ode::Method::dop853, 2);
  ASSERT_EQ(stepper.attempt(f, 0.5, x.data(), slope.data(), 0.25, {}), ode::Attempt::finite);
  ode::DenseStep step;
  ASSERT_EQ(stepper.dense(f, step), ode::Attempt::finite);
  std::vector<double> inside(2);
  for (const std::size_t i : {0U, 2U, 3U, 4U}) {
    const auto b = forms.along(i, step);
    EXPECT_EQ(b.front(), forms.value(i, 0.5, x.data()));
    EXPECT_EQ(b.back(), forms.value(i, 0.75, stepper.x_new()));
    for (const double theta : {0.1, 0.5, 0.7}) {
      step.evaluate(theta, inside.data());
      // A few roundings of terms of the order of one.
      EXPECT_NEAR(ode::evaluate(b, theta), forms.value(i, 0.5 + 0.25 * theta, inside.data()), 1e-14) << i;
    }
  }
}

TEST_F(Forms, ANeighbourhoodOfRoundingSizeIsReached) {
  forms.watch(0, +1);
  constexpr double epsilon = std::numeric_limits<double>::epsilon();
  EXPECT_EQ(suspects(0, 1, {1.0 + 8.0 * epsilon, 0}, {1.5, 0}), (Indices{0}));
  EXPECT_EQ(suspects(0, 1, {1.0 + 1e-9, 0}, {1.5, 0}), Indices{});
}

TEST_F(Forms, BoundsThatAreNotFiniteReachEverything) {
  forms.watch(0, +1);
  forms.watch(3, +1);
  const double infinity = std::numeric_limits<double>::infinity();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(suspects(0, 1, {-infinity, 3}, {infinity, 4}), (Indices{0, 3}));
  EXPECT_EQ(suspects(0, 1, {nan, 3}, {nan, 4}), (Indices{0, 3}));
}

}  // namespace
}  // namespace saltus::event_integrator
