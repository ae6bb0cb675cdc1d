#include "saltus/ode/nested_polynomial.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "../precision.hpp"
#include "polynomials.hpp"

namespace saltus::ode {
namespace {

using namespace trial;
constexpr int degrees[] = {3, 4, 7};

/// c0 + s (c1 + r (c2 + ...)) in more digits.
long double value(const NestedPolynomial& p, long double theta) {
  long double inner = 0.0L;
  for (int k = p.degree; k >= 0; --k) {
    const long double factor = k == p.degree ? 0.0L : k % 2 == 0 ? theta : 1.0L - theta;
    inner = p.c[static_cast<std::size_t>(k)] + factor * inner;
  }
  return inner;
}

NestedPolynomial with_end(NestedPolynomial p) {
  p.end = p.c[0] + p.c[1];
  return p;
}

/// A component along a step: the higher terms of the form get smaller, at most as many times as `decay`.
NestedPolynomial draw(Random& random, int degree, double decay) {
  NestedPolynomial p;
  p.degree = degree;
  double size = 1.0;
  for (int k = 0; k <= degree; ++k, size *= k > 1 ? decay : 1.0) {
    p.c[static_cast<std::size_t>(k)] = size * random.uniform(-1.0, 1.0);
  }
  return with_end(p);
}

BernsteinCoefficients bernstein(const NestedPolynomial& p) {
  std::array<double, event_nodes> values;
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<double>(value(p, interpolation_nodes()[i]));
  return to_bernstein(values);
}

TEST(PlainZero, is_what_the_search_finds) {
  Random random(61);
  int found = 0, none = 0, asked = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    const double decay = std::pow(10.0, random.uniform(-3.0, 0.0));
    const auto p = draw(random, degrees[trial % 3], decay);
    const auto b = bernstein(p);
    const double noise = 32.0 * epsilon * largest(b);
    if (std::abs(p.c[0]) <= noise) continue;
    const int sign = p.c[0] > 0.0 ? 1 : -1;
    const auto zero = plain_zero(p, sign, 0, noise);
    const auto change = first_sign_change(b, sign, 0, noise);
    ++asked;
    if (zero.kind == PlainZero::Kind::none) {
      ++none;
      EXPECT_FALSE(change.has_value()) << trial;
    }
    if (zero.kind != PlainZero::Kind::one) continue;
    ++found;
    ASSERT_TRUE(change.has_value()) << trial;
    const long double h = 1e-6L;
    const auto slope = static_cast<double>((value(p, zero.theta + h) - value(p, zero.theta - h)) / (2.0L * h));
    // The cube of the last correction, 2^-42 at most, times what the other derivatives are over the slope; roundings.
    const double steepness = largest(b) / std::abs(slope);
    const double cube = 0x1p-42 * 42.0 * 42.0 * steepness * steepness;
    EXPECT_NEAR(zero.theta, 0.5 * (change->lower + change->upper), cube + 0x1p-40 + 64.0 * epsilon * steepness)
        << trial;
    // The square, times the third derivative, at most 7 6 5 times 8 largest; and the difference quotient's own.
    EXPECT_NEAR(zero.slope, slope, 1680.0 * largest(b) * (0x1p-28 + 1e-12) + 1e-12) << trial;
  }
  // Higher terms as large as the first ones leave many unclear.
  EXPECT_GT(found + none, asked / 2);
  EXPECT_GT(found, asked / 10);
  EXPECT_GT(none, asked / 10);
}

TEST(PlainZero, behind_a_zero_at_the_start_is_the_other_one) {
  // s (1 + r c2) - s t: starts at 0, rises for t < 1, and comes back where r c2 = t - 1.
  for (const int degree : degrees) {
    NestedPolynomial p;
    p.degree = degree;
    p.c[1] = -0.5;
    p.c[2] = 1.25;
    p = with_end(p);
    const auto zero = plain_zero(p, 1, 1, 0.0);
    ASSERT_EQ(zero.kind, PlainZero::Kind::one) << degree;
    EXPECT_NEAR(zero.theta, 0.6, 4.0 * epsilon);  // -0.5 + 1.25 (1 - theta) = 0; the quotient is linear
    EXPECT_NEAR(zero.slope, -0.6 * 1.25, 1e-12);
    // As rounding may have left it, c0 takes no part.
    p.c[0] = 1e-14;
    EXPECT_EQ(plain_zero(p, 1, 1, 0.0).theta, zero.theta);
    p.c[1] = 0.5;
    EXPECT_EQ(plain_zero(with_end(p), 1, 1, 0.0).kind, PlainZero::Kind::none);
  }
}

TEST(PlainZero, beside_an_extremum_is_as_good_as_elsewhere) {
  // a - theta^2 = a - s + s r, of cycles far shorter than the step.
  for (double a = 1e-12; a < 1.0; a *= 1.7) {
    NestedPolynomial p;
    p.degree = 4;
    p.c = {a, -1.0, 1.0};
    const auto zero = plain_zero(with_end(p), 1, 0, epsilon * a);
    if (zero.kind == PlainZero::Kind::unclear) continue;  // the noise is that of the largest coefficient
    ASSERT_EQ(zero.kind, PlainZero::Kind::one) << a;
    const double expected = std::sqrt(a);
    // a quarter of the cube, 2^-44 of theta; rounding of the values over the slope
    EXPECT_NEAR(zero.theta, expected, 0x1p-43 * expected + 4.0 * epsilon / expected) << a;
    EXPECT_NEAR(zero.slope, -2.0 * expected, 0x1p-27 * expected) << a;
  }
}

TEST(PlainZero, leaves_to_others_what_is_not_plain) {
  Random random(62);
  NestedPolynomial falling = draw(random, 4, 0.0);
  falling.c = {1.0, -2.0};
  falling = with_end(falling);
  ASSERT_EQ(plain_zero(falling, 1, 0, 0.0).kind, PlainZero::Kind::one);
  EXPECT_EQ(plain_zero(falling, 1, 0, 0.0).theta, 0.5);
  // On the other side from the start; a zero of second order there; ends within the noise.
  EXPECT_EQ(plain_zero(falling, -1, 0, 0.0).kind, PlainZero::Kind::unclear);
  EXPECT_EQ(plain_zero(falling, 1, 2, 0.0).kind, PlainZero::Kind::unclear);
  EXPECT_EQ(plain_zero(falling, 1, 0, 0.999).kind, PlainZero::Kind::one);
  EXPECT_EQ(plain_zero(falling, 1, 0, 1.0).kind, PlainZero::Kind::none);
  // Two zeros, 1 - 4.5 s r, and a touch that the noise hides.
  NestedPolynomial dip;
  dip.degree = 4;
  dip.c = {1.0, 0.0, -4.5};
  dip = with_end(dip);
  EXPECT_EQ(plain_zero(dip, 1, 0, 0.0).kind, PlainZero::Kind::unclear);
  dip.c[2] = -2.5;
  EXPECT_EQ(plain_zero(dip, 1, 0, 0.0).kind, PlainZero::Kind::none);
  for (const double bad : {infinity, -infinity, std::nan("")}) {
    for (std::size_t k = 0; k < 5; ++k) {
      auto broken = falling;
      broken.c[k] = bad;
      EXPECT_EQ(plain_zero(broken, 1, 0, 0.0).kind, PlainZero::Kind::unclear) << k;
    }
  }
  NestedPolynomial time_only;  // no state gives it a degree
  time_only.c = {1.0, -2.0};
  EXPECT_EQ(plain_zero(with_end(time_only), 1, 0, 0.0).kind, PlainZero::Kind::unclear);
}

TEST(PlainZero, is_the_same_at_every_scale) {
  Random random(63);
  for (int trial = 0; trial < 1000; ++trial) {
    const auto p = draw(random, degrees[trial % 3], 0.1);
    const int sign = p.c[0] > 0.0 ? 1 : -1;
    const auto zero = plain_zero(p, sign, trial % 2, 1e-12);
    auto scaled = p;
    for (double& c : scaled.c) c *= -0x1p40;
    scaled.end *= -0x1p40;
    const auto other = plain_zero(scaled, -sign, trial % 2, 0x1p40 * 1e-12);
    EXPECT_EQ(zero.kind, other.kind);
    EXPECT_EQ(zero.theta, other.theta);
    EXPECT_EQ(-0x1p40 * zero.slope, other.slope);
  }
}

}  // namespace
}  // namespace saltus::ode
