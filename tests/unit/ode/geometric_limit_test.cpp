#include "saltus/ode/geometric_limit.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace saltus::ode {
namespace {

TEST(GeometricLimit, IsExactForAnyRatioOfTheTerms) {
  for (const double ratio : {-0.9, -0.25, 0.125, 0.5, 0.875}) {
    // 3 + 2 ratio^k
    const SuccessiveTerms terms{3.0 + 2.0, 3.0 + 2.0 * ratio, 3.0 + 2.0 * ratio * ratio};
    // Terms and differences are good to roundings of 5; d_2^2 / (d_1 - d_2) has them over 1 - ratio at most twice.
    EXPECT_NEAR(geometric_limit(terms, 0.875), 3.0, 100.0 * std::numeric_limits<double>::epsilon()) << ratio;
  }
}

TEST(GeometricLimit, DifferencesThatDoNotShrinkLikeTheWholeAreRounding) {
  // The whole shrinks by 1/2: 3/4 is the most that differences may have left.
  EXPECT_EQ(geometric_limit({1.0, 2.0, 2.75}, 0.5), 2.75 + 0.75 * 0.75 / 0.25);
  EXPECT_EQ(geometric_limit({1.0, 2.0, std::nextafter(2.75, 3.0)}, 0.5), std::nextafter(2.75, 3.0));
  EXPECT_EQ(geometric_limit({1.0, 2.0, 0.5}, 0.5), 0.5);
}

TEST(GeometricLimit, WhatRestsStays) {
  EXPECT_EQ(geometric_limit({4.0, 4.0, 4.0}, 0.5), 4.0);
  EXPECT_EQ(geometric_limit({3.0, 4.0, 4.0}, 0.5), 4.0);
}

}  // namespace
}  // namespace saltus::ode
