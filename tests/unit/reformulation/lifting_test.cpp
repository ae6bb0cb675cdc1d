#include "saltus/reformulation/lifting.hpp"

#include <algorithm>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace saltus::reformulation {
namespace {

/// All sign patterns of n functions, + before -, the first function slowest.
linalg::IntMatrix all_patterns(int n) {
  linalg::IntMatrix signs(1 << n, n);
  for (int i = 0; i < signs.rows(); ++i) {
    for (int j = 0; j < n; ++j) signs(i, j) = ((i >> (n - 1 - j)) & 1) == 0 ? 1 : -1;
  }
  return signs;
}

double value(const LiftedProduct& product, const std::vector<double>& alpha, const std::vector<double>& beta) {
  double result = product.beta < 0 ? 1.0 : beta.at(static_cast<std::size_t>(product.beta));
  for (const auto& factor : product.factors) {
    const double one = alpha.at(static_cast<std::size_t>(factor.alpha));
    result *= factor.complement ? 1.0 - one : one;
  }
  return result;
}

std::vector<double> theta(const Lifting& lifting, const std::vector<double>& alpha) {
  std::vector<double> beta;
  for (const auto& product : lifting.beta) beta.push_back(value(product, alpha, beta));
  std::vector<double> result;
  for (const auto& product : lifting.theta) result.push_back(value(product, alpha, beta));
  return result;
}

/// eq. (21), written out.
std::vector<double> theta(const linalg::IntMatrix& signs, const std::vector<double>& alpha) {
  std::vector<double> result;
  for (int i = 0; i < signs.rows(); ++i) {
    double product = 1.0;
    for (int j = 0; j < signs.cols(); ++j) {
      const int s = signs(i, j);
      if (s != 0) product *= (1.0 - s) / 2.0 + s * alpha[static_cast<std::size_t>(j)];
    }
    result.push_back(product);
  }
  return result;
}

std::size_t longest(const Lifting& lifting) {
  std::size_t most = 0;
  for (const auto* products : {&lifting.beta, &lifting.theta}) {
    for (const auto& product : *products) {
      most = std::max(most, product.factors.size() + (product.beta >= 0 ? 1U : 0U));
    }
  }
  return most;
}

void expect_same_multipliers(const linalg::IntMatrix& signs, int most_factors) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  const Lifting lifted = lift(signs, most_factors);
  EXPECT_LE(longest(lifted), static_cast<std::size_t>(most_factors));
  for (int run = 0; run < 5; ++run) {
    std::vector<double> alpha(static_cast<std::size_t>(signs.cols()));
    for (double& one : alpha) one = uniform(random);
    const auto expected = theta(signs, alpha);
    const auto found = theta(lifted, alpha);
    const auto whole = theta(without_lifting(signs), alpha);
    for (std::size_t i = 0; i < expected.size(); ++i) {
      EXPECT_NEAR(found[i], expected[i], 1e-15) << i;
      EXPECT_NEAR(whole[i], expected[i], 1e-15) << i;
    }
  }
}

TEST(Lifting, FullTreesNeedTheNumberOfThePaper) {
  for (int n = 1; n <= 10; ++n) {
    for (int most = 2; most <= 6; ++most) {
      const auto lifted = lift(all_patterns(n), most);
      EXPECT_EQ(static_cast<int>(lifted.beta.size()), most <= n ? (1 << n) - (1 << most) : 0) << n << " " << most;
    }
    expect_same_multipliers(all_patterns(n), 2);
    expect_same_multipliers(all_patterns(n), 3);
    EXPECT_TRUE(without_lifting(all_patterns(n)).beta.empty());
  }
}

/// Example 5 of [nurkanovic2024]: beta = (a1 a2, a1 (1 - a2), (1 - a1) a2, (1 - a1)(1 - a2)).
TEST(Lifting, ThreeFunctions) {
  const auto lifted = lift(all_patterns(3), 2);
  const std::vector<LiftedProduct> beta{{-1, {{0, false}, {1, false}}},
                                        {-1, {{0, false}, {1, true}}},
                                        {-1, {{0, true}, {1, false}}},
                                        {-1, {{0, true}, {1, true}}}};
  EXPECT_EQ(lifted.beta, beta);
  for (int i = 0; i < 8; ++i) {
    EXPECT_EQ(lifted.theta[static_cast<std::size_t>(i)], (LiftedProduct{i / 2, {{2, i % 2 == 1}}})) << i;
  }
}

/// The algorithm as printed gives theta_1 = 0.5 here, and the thetas of the second matrix in another order.
TEST(Lifting, FunctionsThatDoNotMatterToARegion) {
  const linalg::IntMatrix first{{0, 1}, {1, -1}, {-1, -1}};
  EXPECT_EQ(lift(first, 2).theta.front(), (LiftedProduct{-1, {{1, false}}}));
  const linalg::IntMatrix second{{-1, 1}, {-1, -1}, {1, 0}};
  EXPECT_EQ(lift(second, 2).theta.back(), (LiftedProduct{-1, {{0, false}}}));
  for (const auto& signs : {first, second}) expect_same_multipliers(signs, 2);
}

TEST(Lifting, RandomSparseRegions) {
  std::mt19937 random(11);
  std::uniform_int_distribution<int> sign(-1, 1);
  for (int run = 0; run < 200; ++run) {
    linalg::IntMatrix signs(12, 7);
    for (int i = 0; i < signs.rows(); ++i) {
      for (int j = 0; j < signs.cols(); ++j) signs(i, j) = sign(random);
    }
    expect_same_multipliers(signs, 2 + run % 3);
  }
}

}  // namespace
}  // namespace saltus::reformulation
