#include "saltus/switching/selections/selection_complementarity.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace saltus::switching {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd random_matrix(std::mt19937_64& random, Index rows, Index columns) {
  std::uniform_real_distribution<double> entry(-1.0, 1.0);
  return MatrixXd::NullaryExpr(rows, columns, [&] { return entry(random); });
}

/// The conditions themselves, with the mode that was read.
void expect_solved(const Complementarity& found, const MatrixXd& effects, const VectorXd& constant, int instance) {
  const VectorXd y = constant + effects * found.lambda;
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
  std::uniform_real_distribution<double> level(0.2, 2.0);
  int mixed = 0;
  for (int instance = 0; instance < 500; ++instance) {
    const Index r = 1 + instance % 3, m = r + 1 + instance % 4;
    const MatrixXd c = random_matrix(random, m, r);
    const VectorXd mobility = VectorXd::NullaryExpr(r, [&] { return level(random); });
    const VectorXd friction = VectorXd::NullaryExpr(m, [&] { return level(random); });
    const MatrixXd effects = -2.0 * c * mobility.asDiagonal() * c.transpose() * friction.asDiagonal();
    const VectorXd constant = -0.5 * effects * VectorXd::Ones(m) + 0.7 * c * random_matrix(random, r, 1).col(0);
    const auto found = solve_complementarity(effects, constant, 1e-9);
    EXPECT_TRUE(found.unique_velocity) << instance;
    expect_solved(found, effects, constant, instance);
    int moving = 0;
    for (const int mode : found.mode) moving += mode != 0 ? 1 : 0;
    mixed += moving > 0 && moving < m ? 1 : 0;
    // Units of the functions change nothing.
    const VectorXd units = VectorXd::NullaryExpr(m, [&] { return std::exp(10.0 * (level(random) - 1.0)); });
    const auto scaled = solve_complementarity(units.asDiagonal() * effects, units.cwiseProduct(constant), 1e-9);
    EXPECT_EQ(scaled.mode, found.mode) << instance;
  }
  EXPECT_GT(mixed, 30);
}

TEST(SelectionComplementarity, WithoutDominanceNothingIsSaidAboutUniqueness) {
  MatrixXd effects(2, 2);
  effects << 1.0, 0.0,  //
      0.0, -1.0;
  EXPECT_FALSE(solve_complementarity(effects, VectorXd::Constant(2, -0.5), 1e-9).unique_velocity);
  effects << -1.0, 0.5,  //
      -0.5, -1.0;
  EXPECT_FALSE(solve_complementarity(effects, VectorXd::Constant(2, 0.5), 1e-9).unique_velocity);
}

/// The last function is moved by the others, and moves nothing.
TEST(SelectionComplementarity, FunctionsThatMoveNothingLeaveTheVelocityUnique) {
  MatrixXd effects(3, 3);
  effects << -2.0, 1.0, 0.0,  //
      1.0, -2.0, 0.0,         //
      1.0, -1.0, 0.0;
  const auto found = solve_complementarity(effects, VectorXd::Constant(3, 0.5), 1e-9);
  EXPECT_TRUE(found.unique_velocity);
  EXPECT_EQ(found.mode, (std::vector<int>{0, 0, 1}));
}

/// A rotation: monotone, with a diagonal of zero.
TEST(SelectionComplementarity, ExtragradientStepsSolveARotation) {
  MatrixXd effects(2, 2);
  effects << 0.0, 1.0,  //
      -1.0, 0.0;
  VectorXd constant(2);
  constant << -0.5, 0.25;
  const auto found = solve_complementarity(effects, constant, 1e-9);
  expect_solved(found, effects, constant, 0);
  EXPECT_NEAR(found.lambda[0], 0.25, 1e-9);
  EXPECT_NEAR(found.lambda[1], 0.5, 1e-9);
}

}  // namespace
}  // namespace saltus::switching
