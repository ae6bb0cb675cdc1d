#include "saltus/switching/selections/selection_complementarity.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace saltus::switching {
namespace {

using linalg::Index;
using linalg::Matrix;
using linalg::Vector;

Matrix random_matrix(std::mt19937_64& random, Index rows, Index columns) {
  std::uniform_real_distribution<double> entry(-1.0, 1.0);
  Matrix matrix(rows, columns);
  for (double& value : matrix) value = entry(random);
  return matrix;
}

/// Entries in [0.2, 2].
Vector random_levels(std::mt19937_64& random, Index size) {
  std::uniform_real_distribution<double> level(0.2, 2.0);
  Vector levels(size);
  for (double& value : levels) value = level(random);
  return levels;
}

/// The conditions themselves, with the mode that was read.
void expect_solved(const Complementarity& found, const Matrix& effects, const Vector& constant, int instance) {
  const Vector y = constant + effects * found.lambda;
  for (Index i = 0; i < y.size(); ++i) {
    const int mode = found.mode[static_cast<std::size_t>(i)];
    ASSERT_GE(found.lambda[i], 0.0);
    ASSERT_LE(found.lambda[i], 1.0);
    if (mode > 0) {
      EXPECT_TRUE(y[i] > 0.0 && found.lambda[i] == 1.0) << instance;
    } else if (mode < 0) {
      EXPECT_TRUE(y[i] < 0.0 && found.lambda[i] == 0.0) << instance;
    } else {
      EXPECT_LT(std::abs(y[i]), 1e-8) << instance;
    }
  }
}

/// m functions of r variables: W = -C P C' K, of rank r.
TEST(SelectionComplementarity, FrictionHasOneVelocity) {
  std::mt19937_64 random(5);
  int mixed = 0;
  for (int instance = 0; instance < 500; ++instance) {
    const Index r = 1 + instance % 3, m = r + 1 + instance % 4;
    const Matrix c = random_matrix(random, m, r);
    const Vector mobility = random_levels(random, r);
    const Vector friction = random_levels(random, m);
    const Matrix effects = linalg::scaled_cols(-2.0 * linalg::scaled_cols(c, mobility) * c.transpose(), friction);
    const Vector constant = -0.5 * effects * Vector::ones(m) + 0.7 * c * random_matrix(random, r, 1).col(0);
    const auto found = solve_complementarity(effects, constant, 1e-9);
    EXPECT_TRUE(found.unique_velocity) << instance;
    expect_solved(found, effects, constant, instance);
    int moving = 0;
    for (const int mode : found.mode) moving += mode != 0 ? 1 : 0;
    mixed += moving > 0 && moving < m ? 1 : 0;
    // Units of the functions change nothing.
    Vector units = random_levels(random, m);
    for (double& unit : units) unit = std::exp(10.0 * (unit - 1.0));
    const auto scaled = solve_complementarity(linalg::scaled_rows(units, effects), units.times_each(constant), 1e-9);
    EXPECT_EQ(scaled.mode, found.mode) << instance;
  }
  EXPECT_GT(mixed, 30);
}

TEST(SelectionComplementarity, WithoutDominanceNothingIsSaidAboutUniqueness) {
  const Matrix growing{{1.0, 0.0}, {0.0, -1.0}}, turning{{-1.0, 0.5}, {-0.5, -1.0}};
  EXPECT_FALSE(solve_complementarity(growing, Vector::constant(2, -0.5), 1e-9).unique_velocity);
  EXPECT_FALSE(solve_complementarity(turning, Vector::constant(2, 0.5), 1e-9).unique_velocity);
}

/// The last function is moved by the others, and moves nothing.
TEST(SelectionComplementarity, FunctionsThatMoveNothingLeaveTheVelocityUnique) {
  const Matrix effects{{-2.0, 1.0, 0.0}, {1.0, -2.0, 0.0}, {1.0, -1.0, 0.0}};
  const auto found = solve_complementarity(effects, Vector::constant(3, 0.5), 1e-9);
  EXPECT_TRUE(found.unique_velocity);
  EXPECT_EQ(found.mode, (std::vector<int>{0, 0, 1}));
}

/// A rotation: monotone, with a diagonal of zero.
TEST(SelectionComplementarity, ExtragradientStepsSolveARotation) {
  const Matrix effects{{0.0, 1.0}, {-1.0, 0.0}};
  const Vector constant{-0.5, 0.25};
  const auto found = solve_complementarity(effects, constant, 1e-9);
  expect_solved(found, effects, constant, 0);
  EXPECT_NEAR(found.lambda[0], 0.25, 1e-9);
  EXPECT_NEAR(found.lambda[1], 0.5, 1e-9);
}

}  // namespace
}  // namespace saltus::switching
