// Polynomials of the degree of Taylor series: their Bernstein form, and their first sign changes.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "../precision.hpp"
#include "polynomials.hpp"

namespace saltus::ode {
namespace {

using namespace trial;

long double value_of(const SeriesCoefficients& terms, long double theta) {
  long double sum = 0.0L;
  for (std::size_t k = terms.size(); k-- > 0;) sum = terms[k] + theta * sum;
  return sum;
}

double size_of(const SeriesCoefficients& terms) {
  double size = 0.0;
  for (const double term : terms) size += std::abs(term);
  return size;
}

/// Like those of entire functions: rate^k / k!, times anything.
SeriesCoefficients random_terms(Random& random) {
  SeriesCoefficients terms{};
  const double rate = random.uniform(0.1, 4.0);
  double size = 1.0;
  for (std::size_t k = 0; k < terms.size(); ++k) {
    terms[k] = size * random.uniform(-1.0, 1.0);
    size *= rate / static_cast<double>(k + 1);
  }
  return terms;
}

/// factor * product of (theta - zero), as terms; the roundings are those of long double.
SeriesCoefficients terms_with_zeros(const std::vector<double>& zeros, double factor) {
  std::vector<long double> product{factor};
  for (const double zero : zeros) {
    product.push_back(0.0L);
    for (std::size_t k = product.size(); k-- > 0;) product[k] = (k > 0 ? product[k - 1] : 0.0L) - zero * product[k];
  }
  SeriesCoefficients terms{};
  for (std::size_t k = 0; k < product.size(); ++k) terms[k] = static_cast<double>(product[k]);
  return terms;
}

TEST(SeriesForm, is_the_polynomial) {
  Random random(31);
  for (int trial = 0; trial < 500; ++trial) {
    const auto terms = random_terms(random);
    const auto b = to_bernstein(terms);
    EXPECT_EQ(b.front(), terms.front());
    // What it promises, and the roundings of de Casteljau: two per level of numbers that are no larger.
    const double rounding = (series_rounding + 2 * series_degree * 0.5 * epsilon) * size_of(terms);
    for (int k = 0; k <= 32; ++k) {
      EXPECT_NEAR(evaluate(b, k / 32.0), static_cast<double>(value_of(terms, k / 32.0L)), rounding) << trial;
    }
    const double width = 1e-5;
    const auto difference = static_cast<double>(value_of(terms, 0.4L + width) - value_of(terms, 0.4L - width));
    EXPECT_NEAR(derivative(b, 0.4), difference / (2.0 * width), 1e-8 * size_of(terms));
  }
}

TEST(SeriesForm, scales_exactly_with_powers_of_two) {
  Random random(32);
  const auto terms = random_terms(random);
  auto scaled = terms;
  for (double& term : scaled) term *= 0x1p-33;
  const auto b = to_bernstein(terms), other = to_bernstein(scaled);
  for (std::size_t j = 0; j < b.size(); ++j) EXPECT_EQ(b[j] * 0x1p-33, other[j]);
}

TEST(SeriesForm, a_part_is_the_same_polynomial) {
  Random random(33);
  for (int trial = 0; trial < 200; ++trial) {
    const auto terms = random_terms(random);
    const double from = trial % 3 == 0 ? 0.0 : random.uniform(0.0, 0.7);
    const double to = trial % 4 == 0 ? 1.0 : random.uniform(from + 0.1, 1.0);
    const auto part = part_of(to_bernstein(terms), from, to);
    for (int k = 0; k <= 16; ++k) {
      const long double theta = from + (static_cast<long double>(to) - from) * k / 16.0L;
      // Three times de Casteljau.
      EXPECT_NEAR(evaluate(part, k / 16.0), static_cast<double>(value_of(terms, theta)),
                  (series_rounding + 6 * series_degree * 0.5 * epsilon) * size_of(terms));
    }
  }
}

TEST(SeriesForm, first_sign_change_is_that_of_the_first_simple_zero) {
  Random random(34);
  int found = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    std::vector<double> zeros;
    const int count = random.integer(0, 6);
    for (int k = 0; k < count; ++k) zeros.push_back(random.uniform(-0.5, 1.5));
    std::sort(zeros.begin(), zeros.end());
    const auto terms = terms_with_zeros(zeros, random.integer(0, 1) == 0 ? 1.0 : -1.0);
    const auto b = to_bernstein(terms);
    const double noise = 2.0 * series_rounding * size_of(terms);
    const int sign = terms[0] > 0.0 ? 1 : -1;
    const auto first = std::find_if(zeros.begin(), zeros.end(), [](double zero) { return zero > 0.0; });
    const double expected = first == zeros.end() ? 2.0 : *first;
    const double next = first == zeros.end() || first + 1 == zeros.end() ? 2.0 : *(first + 1);
    double depth = 0.0;
    for (int k = 1; k < 64; ++k) {
      const long double theta = expected + (std::min(next, 1.0) - expected) * k / 64.0;
      depth = std::max(depth, -sign * static_cast<double>(value_of(terms, theta)));
    }
    for (const auto& change : {first_sign_change(b, sign, 0, noise), first_sign_change(b, terms, sign, 0, noise)}) {
      if (expected > 1.0) {
        EXPECT_FALSE(change.has_value()) << trial;
      } else if (depth > 2.0 * noise) {
        ++found;
        ASSERT_TRUE(change.has_value()) << "lost " << expected << " in trial " << trial;
        const double slope = static_cast<double>(
            std::abs(value_of(terms, expected + 1e-9L) - value_of(terms, expected - 1e-9L)) / 2e-9L);
        EXPECT_NEAR(change->lower, expected, resolution + 4.0 * noise / slope) << trial;
        EXPECT_LE(change->upper - change->lower, resolution);
        EXPECT_GT(change->upper, change->lower);
      }
    }
  }
  EXPECT_GT(found, 2000);
}

TEST(SeriesForm, zeros_at_the_start_are_not_found_again) {
  Random random(35);
  for (int trial = 0; trial < 1000; ++trial) {
    const int zero_order = random.integer(1, 3);
    std::vector<double> zeros(static_cast<std::size_t>(zero_order), 0.0);
    zeros.push_back(random.uniform(1.1, 2.0));
    const auto none = terms_with_zeros(zeros, -1.0);  // > 0 behind 0
    const double noise = 2.0 * series_rounding * size_of(none);
    EXPECT_FALSE(first_sign_change(to_bernstein(none), none, 1, zero_order, noise).has_value()) << trial;
    zeros.back() = random.uniform(0.05, 0.95);
    const auto one = terms_with_zeros(zeros, -1.0);
    for (const auto& change : {first_sign_change(to_bernstein(one), one, 1, zero_order, noise),
                               first_sign_change(to_bernstein(one), 1, zero_order, noise)}) {
      ASSERT_TRUE(change.has_value()) << trial;
      const double slope = std::pow(zeros.back(), zero_order);
      EXPECT_NEAR(change->lower, zeros.back(), resolution + 4.0 * noise / slope) << trial;
    }
  }
}

TEST(SeriesForm, touches_are_none_and_pairs_of_zeros_are_seen) {
  Random random(36);
  for (int trial = 0; trial < 1000; ++trial) {
    const double place = random.uniform(0.05, 0.95);
    const auto touch = terms_with_zeros({place, place}, 1.0);
    const double noise = 2.0 * series_rounding * size_of(touch);
    EXPECT_FALSE(first_sign_change(to_bernstein(touch), touch, 1, 0, noise).has_value()) << trial;
    const double half = std::sqrt(4.0 * noise) * std::pow(10.0, random.uniform(0.0, 2.0));
    const auto pair = terms_with_zeros({place - half, place + half}, 1.0);
    const auto change = first_sign_change(to_bernstein(pair), pair, 1, 0, noise);
    ASSERT_TRUE(change.has_value()) << trial;
    EXPECT_NEAR(change->lower, place - half, resolution + 0.7 * half) << trial;
    EXPECT_LT(change->upper, place);
  }
}

}  // namespace
}  // namespace saltus::ode
