#include <algorithm>

#include <gtest/gtest.h>

#include "../precision.hpp"
#include "polynomials.hpp"
#include "saltus/ode/only_zero_internal.hpp"

namespace saltus::ode {
namespace {

using namespace trial;

TEST(OnlyZero, is_within_its_bracket) {
  Random random(31);
  int found = 0;
  int asked = 0;
  for (int trial = 0; trial < 5000; ++trial) {
    // One zero inside, also close to either end; the others outside, near or far.
    const double place = random.integer(0, 1) == 0 ? random.uniform(0.0, 1.0) : std::pow(10.0, random.uniform(-9, 0));
    const double expected = random.integer(0, 1) == 0 ? place : 1.0 - place;
    Polynomial p{.factor = 1.0, .zeros = {expected}};
    while (p.zeros.size() < 5) {
      const double away = std::pow(10.0, random.uniform(-0.5, 1.0));
      p.zeros.push_back(random.integer(0, 1) == 0 ? -away : 1.0 + away);
    }
    auto b = p.bernstein();
    if (b.front() < 0.0) {
      for (double& value : b) value = -value;
    }
    if (!(b.front() > 0.0 && b.back() < 0.0)) continue;
    ++asked;
    const auto change = only_zero(b);
    if (!change) continue;
    ++found;
    // The interpolation leaves a few roundings of the largest coefficient, and the zero those over the slope.
    const auto slope = static_cast<double>(std::abs((p(expected + 1e-9L) - p(expected - 1e-9L)) / 2e-9L));
    const double accuracy = 4.0 * epsilon + 64.0 * epsilon * largest(b) / slope;
    EXPECT_LE(change->lower, expected + accuracy);
    EXPECT_GE(change->upper, expected - accuracy);
    EXPECT_LE(change->upper - change->lower, 0x1p-41 + 2.0 * epsilon);
    EXPECT_LE(change->lower, change->upper);
    EXPECT_GE(change->lower, 0.0);
    EXPECT_LE(change->upper, 1.0);
  }
  EXPECT_GT(asked, 4900);
  EXPECT_GT(found, 0.95 * asked);
}

TEST(OnlyZero, gives_up_where_newton_does_not_get_there) {
  const Polynomial sevenfold{.factor = -1.0, .zeros = std::vector<double>(7, 0.3)};
  EXPECT_FALSE(only_zero(sevenfold.bernstein()).has_value());
  BernsteinCoefficients b;
  b.fill(-1.0);
  b.front() = std::nan("");
  EXPECT_FALSE(only_zero(b).has_value());
}

TEST(OnlyZero, is_the_same_at_every_scale) {
  const Polynomial p{.factor = -1.0, .zeros = {0.37, 1.8, -0.4, 2.0}};
  auto b = p.bernstein();
  if (b.front() < 0.0) {
    for (double& value : b) value = -value;
  }
  const auto plain = only_zero(b);
  ASSERT_TRUE(plain.has_value());
  for (double& value : b) value = std::ldexp(value, 60);
  const auto scaled = only_zero(b);
  ASSERT_TRUE(scaled.has_value());
  EXPECT_EQ(plain->lower, scaled->lower);
  EXPECT_EQ(plain->upper, scaled->upper);
}

}  // namespace
}  // namespace saltus::ode
