#include <algorithm>

#include <gtest/gtest.h>

#include "../precision.hpp"
#include "polynomials.hpp"

namespace saltus::ode {
namespace {

using namespace trial;

/// Sign of a polynomial just behind 0.
int sign_behind_zero(const Polynomial& p) { return p(1e-300L) > 0.0L ? 1 : -1; }

/// Noise that covers the rounding of the interpolation.
double rounding(const BernsteinCoefficients& coefficients) { return 32 * epsilon * largest(coefficients); }

TEST(SignChange, finds_the_first_of_simple_zeros) {
  Random random(11);
  for (int trial = 0; trial < 5000; ++trial) {
    Polynomial p{.factor = random.integer(0, 1) == 0 ? 1.0 : -1.0};
    const int zeros = random.integer(0, event_degree);
    for (int k = 0; k < zeros; ++k) p.zeros.push_back(random.uniform(-0.5, 1.5));
    std::sort(p.zeros.begin(), p.zeros.end());
    const auto inside = [](double zero) { return zero > 0.0; };
    const auto first = std::find_if(p.zeros.begin(), p.zeros.end(), inside);
    const double expected = first == p.zeros.end() ? 2.0 : *first;
    const double next = first == p.zeros.end() || first + 1 == p.zeros.end() ? 2.0 : *(first + 1);
    const auto b = p.bernstein();
    const double noise = rounding(b);
    const double sign = sign_behind_zero(p);
    // How far the polynomial gets beyond the zero, before the next one and within the step.
    double depth = 0.0;
    for (int k = 1; k < 64; ++k) {
      const double theta = expected + (std::min(next, 1.0) - expected) * k / 64.0;
      depth = std::max(depth, -sign * static_cast<double>(p(theta)));
    }
    const auto change = first_sign_change(b, static_cast<int>(sign), 0, noise);
    if (expected > 1.0) {
      EXPECT_FALSE(change.has_value()) << "found " << change->lower << " in trial " << trial;
    } else if (depth > 2.0 * noise) {
      ASSERT_TRUE(change.has_value()) << "lost " << expected << " in trial " << trial;
      const double slope = static_cast<double>(std::abs((p(expected + 1e-9L) - p(expected - 1e-9L)) / 2e-9L));
      EXPECT_NEAR(change->lower, expected, resolution + 4.0 * noise / slope) << "trial " << trial;
      EXPECT_LE(change->upper - change->lower, resolution);
      EXPECT_GT(change->upper, change->lower);
    }
  }
}

/// What any result has to fulfil, judged by values on a fine grid.
void expect_consistent(const Polynomial& p, int sign, double noise, const std::optional<SignChange>& change) {
  // Of both the noise that may be given up and the rounding of the interpolant.
  const double allowed = 1.125 * noise;
  const double end = change ? change->lower : 1.0;
  for (int k = 1; k <= 4000; ++k) {
    const double theta = end * k / 4000.0;
    ASSERT_GE(sign * static_cast<double>(p(theta)), -allowed) << "missed at " << theta;
  }
  if (!change) return;
  // Behind the zero, on a grid that starts fine, it is beyond the noise on the other side first.
  for (double away = 1e-12; change->upper + away <= 1.0; away *= 1.01) {
    const double value = sign * static_cast<double>(p(change->upper + away));
    ASSERT_LE(value, allowed) << "no sign change at " << change->lower;
    if (value < -0.875 * noise) return;
  }
  ASSERT_LT(sign * static_cast<double>(p(1.0)), -0.875 * noise) << "no sign change at " << change->lower;
}

TEST(SignChange, agrees_with_dense_sampling) {
  Random random(12);
  int found = 0;
  for (int trial = 0; trial < 1500; ++trial) {
    Polynomial p{.factor = random.uniform(-2.0, 2.0)};
    int degree = 0;
    while (degree < event_degree - 2) {
      const double place = random.uniform(-0.3, 1.3);
      const int multiplicity = random.integer(1, 3);
      const double spread = std::pow(10.0, random.uniform(-12.0, 0.0));
      for (int k = 0; k < multiplicity && degree < event_degree; ++k, ++degree) p.zeros.push_back(place + k * spread);
      if (degree <= event_degree - 2 && random.integer(0, 1) == 0) {
        p.pairs.push_back({random.uniform(0.0, 1.0), std::pow(10.0, random.uniform(-9.0, 0.0))});
        degree += 2;
      }
    }
    const auto b = p.bernstein();
    const double noise = std::max(rounding(b), std::pow(10.0, random.uniform(-14.0, -3.0)) * largest(b));
    int sign = sign_behind_zero(p);
    if (std::abs(b.front()) <= noise && random.integer(0, 1) == 0) sign = -sign;  // as good as the other one
    const auto change = first_sign_change(b, sign, 0, noise);
    found += change ? 1 : 0;
    expect_consistent(p, sign, noise, change);
    if (HasFatalFailure()) FAIL() << "trial " << trial;
  }
  EXPECT_GT(found, 300);
  EXPECT_LT(found, 1200);
}

TEST(SignChange, touches_are_none_and_pairs_of_zeros_are_seen) {
  Random random(13);
  for (int trial = 0; trial < 2000; ++trial) {
    const double place = random.uniform(0.05, 0.95);
    Polynomial p{.factor = 1.0, .zeros = {place, place}};
    for (int k = 0; k < 3; ++k) p.pairs.push_back({random.uniform(-1.0, 2.0), random.uniform(0.1, 1.0)});
    const double noise = rounding(p.bernstein());
    EXPECT_FALSE(first_sign_change(p.bernstein(), 1, 0, noise).has_value()) << "trial " << trial;
    // Two zeros at a distance that makes the dip 4 noise deep, or more.
    double curvature = 1.0;
    for (const auto& pair : p.pairs) {
      curvature *= (place - pair.centre) * (place - pair.centre) + pair.distance * pair.distance;
    }
    const double half = std::sqrt(4.0 * noise / curvature) * std::pow(10.0, random.uniform(0.0, 2.0));
    if (half > 0.02) continue;
    p.zeros = {place - half, place + half};
    const auto change = first_sign_change(p.bernstein(), 1, 0, noise);
    ASSERT_TRUE(change.has_value()) << "trial " << trial;
    EXPECT_NEAR(change->lower, place - half, resolution + 0.7 * half) << "trial " << trial;
    EXPECT_LT(change->upper, place);
  }
}

TEST(SignChange, zeros_at_the_start_are_not_found_again) {
  Random random(14);
  for (int trial = 0; trial < 2000; ++trial) {
    const int zero_order = random.integer(1, 3);
    Polynomial p{.factor = 1.0, .zeros = std::vector<double>(static_cast<std::size_t>(zero_order), 0.0)};
    const auto none = p.bernstein();
    EXPECT_FALSE(first_sign_change(none, 1, zero_order, rounding(none)).has_value());
    const double next = std::pow(10.0, random.uniform(zero_order < 3 ? -4.0 : -3.0, -0.1));
    p.zeros.push_back(next);
    p.zeros.push_back(random.uniform(1.1, 2.0));
    p.factor = random.integer(0, 1) == 0 ? 1.0 : -1.0;
    auto b = p.bernstein();
    const double noise = rounding(b);
    b[0] = random.uniform(-1.0, 1.0) * noise;  // what a computed zero looks like
    const auto change = first_sign_change(b, sign_behind_zero(p), zero_order, noise);
    ASSERT_TRUE(change.has_value());
    const double slope = std::pow(next, zero_order);
    EXPECT_NEAR(change->lower, next, resolution + 2.0 * noise / slope);
    // With the other sign expected the start is a sign change itself, just not one that is hidden.
    const auto other = first_sign_change(b, -sign_behind_zero(p), zero_order, noise);
    ASSERT_TRUE(other.has_value());
    EXPECT_EQ(other->lower, 0.0);
  }
}

TEST(SignChange, zero_that_hides_in_the_noise_behind_the_start) {
  // theta (theta - 1e-8): the hump between both zeros is within the noise, the other side is not.
  const Polynomial p{.factor = -1.0, .zeros = {0.0, 1e-8}};
  const auto change = first_sign_change(p.bernstein(), 1, 1, 1e-14);
  ASSERT_TRUE(change.has_value());
  EXPECT_NEAR(change->lower, 1e-8, 1e-15 + resolution);
}

TEST(SignChange, zero_at_the_end_belongs_to_the_next_step) {
  const Polynomial p{.factor = -1.0, .zeros = {1.0}, .pairs = {{0.4, 1.0}}};
  EXPECT_FALSE(first_sign_change(p.bernstein(), 1, 0, 1e-15).has_value());
  auto b = p.bernstein();
  b.back() = -0.9e-15;
  EXPECT_FALSE(first_sign_change(b, 1, 0, 1e-15).has_value());
  b.back() = -1.1e-15;
  const auto at_end = first_sign_change(b, 1, 0, 1e-15);
  ASSERT_TRUE(at_end.has_value());
  EXPECT_NEAR(at_end->upper, 1.0, 1e-12);
  // The next step starts within the noise, or just beyond it, and turns to the other side.
  for (const double start : {0.9e-15, 0.0, -0.9e-15, -1.1e-15}) {
    const Polynomial q{.factor = -1.0, .zeros = {0.0}, .pairs = {{0.4, 1.0}}};
    b = q.bernstein();
    b.front() = start;
    const auto change = first_sign_change(b, 1, 0, 1e-15);
    ASSERT_TRUE(change.has_value());
    EXPECT_EQ(change->lower, 0.0);
    EXPECT_LT(change->upper, 1e-11);
  }
}

TEST(SignChange, all_three_zeros_of_a_cubic_in_one_step) {
  // y' = 3 t^2 + 12 t - 4, y(-8) = -120: zeros -6, -2, 2, searched one after the other on [start, 10].
  const double end = 10.0;
  double start = -8.0;
  int sign = -1;
  int zero_order = 0;
  for (const double expected : {-6.0, -2.0, 2.0}) {
    Polynomial p{.factor = std::pow(end - start, 3)};
    for (const double zero : {-6.0, -2.0, 2.0}) p.zeros.push_back((zero - start) / (end - start));
    const auto b = p.bernstein();
    const auto change = first_sign_change(b, sign, zero_order, rounding(b));
    ASSERT_TRUE(change.has_value());
    EXPECT_NEAR(start + (end - start) * change->lower, expected, 1e-10);
    start = expected;
    sign = -sign;
    zero_order = 1;
  }
}

TEST(SignChange, scaling_by_powers_of_two_changes_no_bit) {
  Random random(15);
  int found = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    Polynomial p{.factor = 1.0};
    const int zero_order = random.integer(0, 2);
    for (int k = 0; k < zero_order; ++k) p.zeros.push_back(0.0);
    while (p.zeros.size() < 6) p.zeros.push_back(random.uniform(0.0, 2.0));
    const int sign = sign_behind_zero(p);
    const auto b = p.bernstein();
    const auto plain = first_sign_change(b, sign, zero_order, rounding(b));
    found += plain ? 1 : 0;
    for (const int exponent : {-26, 26, 100}) {
      auto scaled = b;
      for (double& value : scaled) value = std::ldexp(value, exponent);
      const auto change = first_sign_change(scaled, sign, zero_order, std::ldexp(rounding(b), exponent));
      ASSERT_EQ(change.has_value(), plain.has_value());
      if (!plain) continue;
      EXPECT_EQ(change->lower, plain->lower);
      EXPECT_EQ(change->upper, plain->upper);
    }
    // The negated polynomial changes its sign at the same place, too.
    auto negated = b;
    for (double& value : negated) value = -value;
    const auto negated_change = first_sign_change(negated, -sign, zero_order, rounding(b));
    ASSERT_EQ(negated_change.has_value(), plain.has_value());
    if (plain) {
      EXPECT_EQ(negated_change->lower, plain->lower);
    }
  }
  EXPECT_GT(found, 1000);
}

TEST(SignChange, cheap_rejection_never_hides_one) {
  Random random(16);
  int rejected = 0;
  for (int trial = 0; trial < 5000; ++trial) {
    BernsteinCoefficients b;
    for (double& value : b) value = random.uniform(-0.05, 1.0);
    const int zero_order = random.integer(0, 2);
    const double noise = random.uniform(0.0, 0.05);
    if (!certainly_no_sign_change(b, 1, zero_order, noise)) continue;
    ++rejected;
    EXPECT_FALSE(first_sign_change(b, 1, zero_order, noise).has_value());
    for (int i = 0; i < zero_order; ++i) b[static_cast<std::size_t>(i)] = 0.0;
    for (int k = 0; k <= 50; ++k) EXPECT_GE(evaluate(b, k / 50.0), -noise);
  }
  EXPECT_GT(rejected, 500);
  EXPECT_TRUE(certainly_no_sign_change({-1, -1, -1, -1, -1, -1, -1, -1, -1}, -1, 0, 0.0));
  EXPECT_FALSE(certainly_no_sign_change({-1, -1, -1, -1, 2, -1, -1, -1, -1}, -1, 0, 1.0));
  EXPECT_FALSE(certainly_no_sign_change({1, 1, 1, 1, std::nan(""), 1, 1, 1, 1}, 1, 0, 1.0));
}

TEST(SignChange, ends_quickly_where_rounding_decides) {
  // An eightfold zero without noise, and polynomials that tie with the noise: every value is a rounding error.
  const Polynomial eightfold{.factor = 1.0, .zeros = std::vector<double>(8, 1.0 / 3.0)};
  const auto change = first_sign_change(eightfold.bernstein(), 1, 0, 0.0);
  if (change) {
    EXPECT_NEAR(change->lower, 1.0 / 3.0, 0.05);
  }
  Random random(17);
  for (int trial = 0; trial < 2000; ++trial) {
    BernsteinCoefficients b;
    for (double& value : b) value = -1.0 - random.integer(-3, 3) * epsilon;
    b.front() = -1.0;
    const auto tie = first_sign_change(b, 1, 0, 1.0);
    if (tie) {
      EXPECT_LE(tie->lower, tie->upper);
    }
  }
  for (const double value : {0.0, -0.0, 1.0, -1.0}) {
    BernsteinCoefficients constant;
    constant.fill(value);
    EXPECT_FALSE(first_sign_change(constant, 1, 0, 1.0).has_value());
  }
}

}  // namespace
}  // namespace saltus::ode
