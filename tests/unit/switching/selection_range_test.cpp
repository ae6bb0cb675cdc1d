#include "saltus/switching/selections/selection_range.hpp"

#include <cmath>
#include <cstddef>
#include <random>

#include <gtest/gtest.h>

#include "saltus/linalg/factors.hpp"

namespace saltus::switching {
namespace {

using linalg::Index;
using linalg::Matrix;
using linalg::Vector;

/// Entries in [-1, 1], r rows.
Matrix random_effects(std::mt19937_64& random, Index r, Index q) {
  std::uniform_real_distribution<double> entry(-1.0, 1.0);
  Matrix matrix(r, q);
  for (double& value : matrix) value = entry(random);
  return matrix;
}

/// Differences of n states, the last one at 0.
Matrix differences(Index n) {
  Matrix effects = Matrix::zero(n - 1, n * (n - 1) / 2);
  Index column = 0;
  for (Index i = 0; i < n; ++i) {
    for (Index j = 0; j < i; ++j, ++column) {
      if (i < n - 1) effects(i, column) = 1.0;
      effects(j, column) = -1.0;
    }
  }
  return effects;
}

TEST(SelectionRange, OfThreeDirectionsInThePlaneIsAHexagon) {
  const Matrix effects{{1.0, 0.0, 1.0}, {0.0, 2.0, 2.0}};
  SelectionRange range;
  ASSERT_TRUE(range.set(effects));
  ASSERT_EQ(range.facets().size(), 3U);
  // First coordinate from 0 to 2 in halves of its size 2, from a = -1.
  const Vector constant = Vector::constant(2, -1.0);
  for (std::size_t f = 0; f < 3; ++f) {
    const auto& facets = range.facets()[f];
    double sum = 0.0;
    for (Index i = 0; i < 3; ++i) sum += std::abs(facets.normal.dot(effects.col(i)));
    EXPECT_NEAR(sum, 1.0, 1e-14);
    EXPECT_NEAR(range.span(f, constant).max - range.span(f, constant).min, 1.0, 1e-14);
    if (facets.sign[1] == 0) {
      EXPECT_NEAR(range.span(f, constant).min, -0.5, 1e-14);
    }
    if (facets.sign[0] == 0) {
      EXPECT_NEAR(range.span(f, constant).min, -0.25, 1e-14);
    }
  }
}

/// The permutohedron of n states has 2^n - 2 facets.
TEST(SelectionRange, OfAllDifferencesHasAFacetPerSubset) {
  for (const Index n : {3, 4, 5, 6, 9}) {
    SelectionRange range;
    ASSERT_TRUE(range.set(differences(n)));
    EXPECT_EQ(range.facets().size(), (std::size_t{1} << n) / 2 - 1) << n;
  }
}

TEST(SelectionRange, HoldsZeroExactlyWhereSelectionsDo) {
  std::mt19937_64 random(11);
  int held = 0, lost = 0;
  for (int instance = 0; instance < 2000; ++instance) {
    const Index r = 1 + instance % 4, q = r + instance % 3;
    const Matrix effects = random_effects(random, r, q);
    const Vector constant = -effects * Vector::constant(q, 0.5) + 0.6 * random_effects(random, r, 1).col(0);
    SelectionRange range;
    ASSERT_TRUE(range.set(effects));
    double margin = 1.0;
    for (std::size_t f = 0; f < range.facets().size(); ++f) {
      const auto span = range.span(f, constant);
      margin = std::min({margin, span.max, -span.min});
    }
    if (std::abs(margin) < 1e-6) continue;
    const Vector lambda = bounded_selections(effects, constant);
    ASSERT_GE(lambda.min(), 0.0);
    ASSERT_LE(lambda.max(), 1.0);
    const double residual = (constant + effects * lambda).max_abs();
    if (margin > 0.0) {
      EXPECT_LT(residual, 1e-9) << instance;
      ++held;
    } else {
      EXPECT_GT(residual, 1e-8) << instance;
      ++lost;
    }
  }
  EXPECT_GT(held, 500);
  EXPECT_GT(lost, 200);
}

TEST(SelectionRange, CentralSelectionsAreTheNearestOnes) {
  std::mt19937_64 random(3);
  const Matrix effects = random_effects(random, 3, 6);
  const Vector constant = random_effects(random, 3, 1).col(0);
  const Vector lambda = central_selections(effects, constant);
  EXPECT_LT((constant + effects * lambda).norm(), 1e-13);
  // What they differ from 1/2 by is in the row space.
  const Vector offset = lambda - Vector::constant(6, 0.5);
  const Vector multipliers = linalg::Ldl(effects * effects.transpose()).solve(effects * offset);
  EXPECT_LT((effects.transpose() * multipliers - offset).norm(), 1e-12);
}

TEST(SelectionRange, RefusesWhatHasNoVolumeOrTooManyFacets) {
  SelectionRange range;
  const Matrix flat{{1.0, 2.0, 3.0}, {2.0, 4.0, 6.0}};
  EXPECT_FALSE(range.set(flat));
  EXPECT_FALSE(range.set(Matrix::constant(2, 1, 1.0)));
  EXPECT_FALSE(range.set(differences(12)));
  EXPECT_TRUE(range.set(differences(3)));
}

}  // namespace
}  // namespace saltus::switching
