#include "saltus/switching/plane/bilinear_root.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace saltus::switching {
namespace {

double g_at(const PairCorners& g, std::size_t j, double a, double b) {
  return (1 - b) * ((1 - a) * g[0][j] + a * g[1][j]) + b * ((1 - a) * g[2][j] + a * g[3][j]);
}

double determinant(const BilinearRoot& root) { return root.G[0][0] * root.G[1][1] - root.G[0][1] * root.G[1][0]; }

PairCorners random_corners(std::mt19937_64& generator) {
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  PairCorners g;
  for (auto& corner : g) corner = {uniform(generator), uniform(generator)};
  return g;
}

// The residual over |G| is the error of the selections: conditioned by 1/det G, and by the size of the selections.
TEST(BilinearRoot, SolvesTheSystemWithTheSignOfDetGThatWasAskedFor) {
  std::mt19937_64 generator(1);
  int with_roots = 0;
  for (int k = 0; k < 20000; ++k) {
    const PairCorners g = random_corners(generator);
    for (const auto kind : {RootKind::rising, RootKind::falling}) {
      const BilinearRoot root = bilinear_root(g, kind);
      if (!(root.discriminant > 1e-4)) continue;
      ++with_roots;
      const double reach = std::max({1.0, std::abs(root.alpha[0]), std::abs(root.alpha[1])});
      if (reach > 1e3) continue;
      const double scale = 1e-11 * reach * reach / root.discriminant;
      for (std::size_t j = 0; j < 2; ++j) {
        EXPECT_NEAR(g_at(g, j, root.alpha[0], root.alpha[1]), 0.0, scale) << k;
        EXPECT_NEAR(root.from_one[j], root.alpha[j] - 1.0, scale) << k;
      }
      EXPECT_GT(determinant(root) * (kind == RootKind::rising ? 1.0 : -1.0), 0.0) << k;
    }
  }
  EXPECT_GT(with_roots, 20000);
}

TEST(BilinearRoot, StabilityHasTheSignOfCondition412) {
  std::mt19937_64 generator(2);
  int stable = 0, unstable = 0;
  for (int k = 0; k < 20000; ++k) {
    const BilinearRoot root = bilinear_root(random_corners(generator), RootKind::rising);
    if (!(root.discriminant > 1e-4)) continue;
    const double smaller = std::min(root.G[0][0], root.G[1][1]);
    if (std::abs(smaller) < 1e-9) continue;
    EXPECT_EQ(root.stability > 0.0, smaller < 0.0) << k;
    (smaller < 0.0 ? stable : unstable)++;
  }
  EXPECT_GT(stable, 1000);
  EXPECT_GT(unstable, 1000);
}

// Three velocities on a line through the origin but for 1e-4 to 1e-13, the fourth between two of them: G has rank one
// but for that, and what rounding leaves of the selections (which shows in g) is 1e-16 over it.
TEST(BilinearRoot, SelectionsLeaveNothingOfTheFieldsHoweverSmallTheDeterminantIs) {
  std::mt19937_64 generator(4);
  std::uniform_real_distribution<double> uniform(0.1, 1.0);
  int ill_conditioned = 0;
  for (int k = 0; k < 60000; ++k) {
    const double width = std::pow(10.0, -4.0 - 9.0 * k / 60000.0);
    const double across = uniform(generator), along = uniform(generator);
    PairCorners g;
    const auto velocity = [&](double way, double beside) {
      return std::array<double, 2>{way * along - width * beside * across, way * across + width * beside * along};
    };
    g[0] = velocity(-uniform(generator), uniform(generator));
    g[1] = velocity(uniform(generator), uniform(generator));
    g[2] = velocity(uniform(generator) - 0.5, -uniform(generator));
    g[3] = velocity(uniform(generator) - 0.5, -uniform(generator));
    const BilinearRoot root = bilinear_root(g, RootKind::rising);
    if (!(root.discriminant > 0.0)) continue;
    if (std::min(root.alpha[0], root.alpha[1]) < 0.0 || std::max(root.from_one[0], root.from_one[1]) > 0.0) continue;
    const auto alpha = balanced_selections(g, root);
    const double condition = std::max(root.condition[0], root.condition[1]);
    if (condition > 1e7) ++ill_conditioned;
    for (std::size_t j = 0; j < 2; ++j) {
      // Three products and sums of terms up to 1.2; 1e-10 where they are not balanced.
      EXPECT_LE(std::abs(g_at(g, j, alpha[0], alpha[1])), condition > 2.5e5 ? 2e-15 : 1e-10) << k;
      // The errors of both selections, four roundings of 2.2e-16 each.
      EXPECT_NEAR(alpha[j], root.alpha[j], 2e-15 * condition) << k;
    }
  }
  EXPECT_GT(ill_conditioned, 1000);
}

// On the edge alpha_1 = 0 both components are affine in alpha_2 with a common zero: 3 (1 - b) - 1 b and 1.5 (1 - b) -
// 0.5 b.
TEST(BilinearRoot, ABoundIsReachedExactlyAndApproachedWithoutCancellation) {
  PairCorners g{{{3.0, 1.5}, {-1.0, 2.0}, {-1.0, -0.5}, {-2.0, -1.0}}};
  EXPECT_EQ(bilinear_root(g, RootKind::rising).alpha[0], 0.0);
  EXPECT_EQ(bilinear_root(g, RootKind::rising).alpha[1], 0.75);
  const double slope =
      (g_at(g, 0, 1.0, 0.75) - g_at(g, 0, 0.0, 0.75)) * 2.0 - (g_at(g, 1, 1.0, 0.75) - g_at(g, 1, 0.0, 0.75)) * 4.0;
  g[0][0] += 1e-30;  // lost in 3: the corner is what it was
  EXPECT_EQ(bilinear_root(g, RootKind::rising).alpha[0], 0.0);
  ASSERT_NE(slope, 0.0);
  // g(alpha_1, b) with the first row moved by 1e-12 at one corner: alpha_1 moves by that over the determinant, to nine
  // digits.
  g[0][0] = 3.0 + 0x1p-40;
  const double moved = bilinear_root(g, RootKind::rising).alpha[0];
  const double p_prime = determinant(bilinear_root(g, RootKind::rising));
  EXPECT_NEAR(moved * p_prime / (0.5 * 0x1p-40), 1.0, 1e-9);
}

// g_1 = a - b - c, g_2 = a b - e in shifted selections: the roots meet where c^2 = -4 e, and have gone behind.
TEST(BilinearRoot, TheDoubleRootIsContinuedWhereBothRootsHaveVanished) {
  const auto corners = [](double e) {
    PairCorners g;
    for (std::size_t k = 0; k < 4; ++k) {
      const double a = (k & 1U) != 0 ? 1.0 : 0.0;
      const double b = (k & 2U) != 0 ? 1.0 : 0.0;
      g[k] = {a - b - 0.25, (a - 0.5) * (b - 0.5) + e};
    }
    return g;
  };
  // a = b + 1/4: (b - 1/4)(b - 1/2) = -e, double at b = 3/8 for e = 1/64.
  for (const auto kind : {RootKind::rising, RootKind::falling}) {
    const double sign = kind == RootKind::rising ? 1.0 : -1.0;
    const BilinearRoot before = bilinear_root(corners(1.0 / 64 - 1e-6), kind);
    EXPECT_GT(before.discriminant, 0.0);
    EXPECT_NEAR(std::abs(before.alpha[1] - 0.375), 1e-3, 1e-12);
    EXPECT_GT(determinant(before) * sign, 0.0);
    for (const double e : {0.0, 1e-6, 1e-2}) {
      const BilinearRoot beyond = bilinear_root(corners(1.0 / 64 + e), kind);
      EXPECT_LE(beyond.discriminant, 0.0);
      EXPECT_NEAR(beyond.alpha[0], 0.625, 1e-15);
      EXPECT_NEAR(beyond.alpha[1], 0.375, 1e-15);
    }
  }
}

TEST(BilinearRoot, RowsScaledByAPowerOfTwoChangeNothing) {
  std::mt19937_64 generator(3);
  for (int k = 0; k < 1000; ++k) {
    const PairCorners g = random_corners(generator);
    PairCorners scaled = g;
    for (auto& corner : scaled) {
      corner[0] *= 0x1p30;
      corner[1] *= 0x1p-40;
    }
    const BilinearRoot a = bilinear_root(g, RootKind::rising);
    const BilinearRoot b = bilinear_root(scaled, RootKind::rising);
    for (std::size_t j = 0; j < 2; ++j) {
      EXPECT_EQ(a.alpha[j], b.alpha[j]);
      EXPECT_EQ(a.from_one[j], b.from_one[j]);
      EXPECT_EQ(a.condition[j], b.condition[j]);
    }
    EXPECT_EQ(a.discriminant, b.discriminant);
    EXPECT_EQ(a.stability, b.stability);
  }
}

}  // namespace
}  // namespace saltus::switching
