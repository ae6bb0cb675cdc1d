#include "saltus/pipeline/level_curves.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace saltus::pipeline {
namespace {

constexpr Interval side{-2.0, 2.0};
/// Distance from the curve that level_curve_tolerance allows in a box with sides of 4.
constexpr double allowed = 4.0 * level_curve_tolerance;

/// Largest of `error` over all points and the middles of all chords.
template <class Error>
double worst(const std::vector<Polyline>& curves, Error error) {
  double most = 0.0;
  for (const auto& curve : curves) {
    for (std::size_t i = 0; i < curve.x.size(); ++i) {
      most = std::max(most, error(curve.x[i], curve.y[i]));
      if (i > 0) most = std::max(most, error(0.5 * (curve.x[i] + curve.x[i - 1]), 0.5 * (curve.y[i] + curve.y[i - 1])));
    }
  }
  return most;
}

double nearest(const std::vector<Polyline>& curves, double x, double y) {
  double least = std::numeric_limits<double>::infinity();
  for (const auto& curve : curves) {
    for (std::size_t i = 0; i < curve.x.size(); ++i)
      least = std::min(least, std::hypot(curve.x[i] - x, curve.y[i] - y));
  }
  return least;
}

TEST(LevelCurves, ACircleIsOneClosedPieceOnTheCircle) {
  const auto curves = level_curves([](double x, double y) { return x * x + y * y - 1.0; }, side, side);
  ASSERT_EQ(curves.size(), 1U);
  const auto& [x, y] = curves.front();
  EXPECT_EQ(x.front(), x.back());
  EXPECT_EQ(y.front(), y.back());
  EXPECT_LT(worst(curves, [](double a, double b) { return std::abs(std::hypot(a, b) - 1.0); }), allowed);
  // All of it: the length is that of the circle.
  double length = 0.0;
  for (std::size_t i = 1; i < x.size(); ++i) length += std::hypot(x[i] - x[i - 1], y[i] - y[i - 1]);
  EXPECT_NEAR(length, 2.0 * std::numbers::pi, 1e-3);
}

TEST(LevelCurves, OpenPiecesEndAtTheBox) {
  const auto curves = level_curves([](double x, double y) { return x * y - 0.25; }, side, side);
  ASSERT_EQ(curves.size(), 2U);
  for (const auto& curve : curves) {
    for (const std::size_t i : {std::size_t{0}, curve.x.size() - 1}) {
      EXPECT_NEAR(std::max(std::abs(curve.x[i]), std::abs(curve.y[i])), 2.0, 1e-12);
    }
  }
  EXPECT_LT(worst(curves, [](double x, double y) { return std::abs(x * y - 0.25) / std::hypot(x, y); }), allowed);
}

TEST(LevelCurves, SaddlesAreConnectedAsTheirMiddleSays) {
  // Two lines through the middle of a cell, parted by a little: pieces must not cross the saddle.
  const double at = 0.5 * 4.0 / level_curve_cells;
  for (const double sign : {1.0, -1.0}) {
    const auto curves = level_curves([&](double x, double y) { return (x - at) * (y - at) - sign * 1e-5; }, side, side);
    ASSERT_EQ(curves.size(), 2U);
    for (const auto& curve : curves) {
      for (std::size_t i = 0; i < curve.x.size(); ++i) {
        EXPECT_GT(sign * (curve.x[i] - at) * (curve.y[i] - at), 0.0);
      }
    }
  }
}

TEST(LevelCurves, CornersAreCornersAndNotCutOff) {
  // Corners that lie on no line of the grid.
  const double x0 = 0.1234, y0 = -0.0567;
  const auto curves =
      level_curves([&](double x, double y) { return std::abs(x - x0) + std::abs(y - y0) - 1.0; }, side, side);
  ASSERT_EQ(curves.size(), 1U);
  for (const auto& [dx, dy] : {std::pair{1.0, 0.0}, {-1.0, 0.0}, {0.0, 1.0}, {0.0, -1.0}}) {
    EXPECT_LT(nearest(curves, x0 + dx, y0 + dy), 2.0 * allowed);
  }
}

TEST(LevelCurves, TheBorderGoesOnWhereTheFunctionJumps) {
  const auto curves = level_curves([](double x, double y) { return y - (x > 0.1 ? 0.5 : -0.5); }, side, side);
  ASSERT_EQ(curves.size(), 1U);
  EXPECT_LT(nearest(curves, 0.1, 0.5), 2.0 * allowed);
  EXPECT_LT(nearest(curves, 0.1, -0.5), 2.0 * allowed);
}

TEST(LevelCurves, NothingWhereTheFunctionIsUndefinedOrHasOneSign) {
  const auto curves = level_curves([](double x, double y) { return std::log(x) + y; }, side, side);
  ASSERT_EQ(curves.size(), 1U);
  for (const double x : curves.front().x) EXPECT_GT(x, 0.0);
  EXPECT_TRUE(level_curves([](double, double) { return 1.0; }, side, side).empty());
  EXPECT_TRUE(level_curves([](double, double) { return std::nan(""); }, side, side).empty());
}

TEST(LevelCurves, SidesOfVeryDifferentSizeAreTreatedAlike) {
  const double small = 1e-7, large = 1e5;
  const auto curves = level_curves([&](double x, double y) { return std::hypot(x / small, y / large) - 1.0; },
                                   {-2.0 * small, 2.0 * small}, {-2.0 * large, 2.0 * large});
  ASSERT_EQ(curves.size(), 1U);
  EXPECT_LT(worst(curves, [&](double x, double y) { return std::abs(std::hypot(x / small, y / large) - 1.0); }),
            allowed);
}

TEST(SignChanges, AreFoundToTheLastDigits) {
  const auto found = sign_changes([](double x) { return std::sin(x); }, {0.5, 10.0});
  ASSERT_EQ(found.size(), 3U);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(found[k], static_cast<double>(k + 1) * std::numbers::pi, 1e-14 * 10.0);
  }
  EXPECT_TRUE(sign_changes([](double x) { return (x - 0.1234) * (x - 0.1234); }, {-1.0, 1.0}).empty());
}

}  // namespace
}  // namespace saltus::pipeline
