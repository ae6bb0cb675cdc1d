#include "saltus/pipeline/random_numbers.hpp"

#include <cmath>
#include <cstdint>

#include <gtest/gtest.h>

namespace saltus::pipeline {
namespace {

/// The first two words of philox4x32-10 as 53 bits.
double from_words(std::uint32_t first, std::uint32_t second) {
  const auto bits = ((std::uint64_t{first} << 21U) ^ (second >> 11U)) & ((std::uint64_t{1} << 53U) - 1U);
  return (static_cast<double>(bits) + 0.5) * 0x1p-53;
}

TEST(RandomNumbers, AreThePublishedOnesOfThatGenerator) {
  // Known answers of the generator: counter and key zero.
  EXPECT_EQ(uniform_number(0, 0, 0), from_words(0x6627e8d5U, 0xe169c58dU));
}

TEST(RandomNumbers, DependOnSeedPlaceAndStream) {
  const double number = uniform_number(1, 2, 3);
  EXPECT_EQ(uniform_number(1, 2, 3), number);
  EXPECT_NE(uniform_number(2, 2, 3), number);
  EXPECT_NE(uniform_number(1, 3, 3), number);
  EXPECT_NE(uniform_number(1, 2, 4), number);
}

TEST(RandomNumbers, AreUniform) {
  constexpr int count = 100000;
  double sum = 0.0, squares = 0.0;
  for (int i = 0; i < count; ++i) {
    const double number = uniform_number(5, static_cast<std::uint64_t>(i), 0);
    ASSERT_GT(number, 0.0);
    ASSERT_LT(number, 1.0);
    sum += number;
    squares += number * number;
  }
  // Four standard deviations of the means: 1/sqrt(12 n) and sqrt(4/45/n).
  EXPECT_NEAR(sum / count, 0.5, 4.0 / std::sqrt(12.0 * count));
  EXPECT_NEAR(squares / count, 1.0 / 3.0, 4.0 * std::sqrt(4.0 / 45.0 / count));
}

TEST(NormalQuantile, IsTheInverseOfTheDistribution) {
  for (const double p : {1e-300, 1e-30, 1e-9, 0.001, 0.02, 0.074, 0.076, 0.3, 0.5, 0.7, 0.9, 0.999}) {
    const double x = normal_quantile(p);
    const double there = 0.5 * std::erfc(-x / std::sqrt(2.0));
    // An error dx of x is x dx of log p in the tails.
    EXPECT_NEAR(there / p, 1.0, 1e-14 * (1.0 + x * x)) << p;
  }
  EXPECT_EQ(normal_quantile(0.5), 0.0);
  EXPECT_EQ(normal_quantile(0.25), -normal_quantile(0.75));
}

}  // namespace
}  // namespace saltus::pipeline
