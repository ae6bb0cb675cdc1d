#include "saltus/ode/straight_lines.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

namespace saltus::ode {
namespace {

/// Largest distance of a curve of one column from the lines over these points.
template <class Curve>
double largest_distance(Curve curve, const std::vector<double>& inside, double end) {
  std::vector<double> points{0.0};
  points.insert(points.end(), inside.begin(), inside.end());
  points.push_back(end);
  double largest = 0.0;
  for (std::size_t k = 0; k + 1 < points.size(); ++k) {
    for (int i = 0; i <= 100; ++i) {
      const double part = i / 100.0, theta = points[k] + part * (points[k + 1] - points[k]);
      const double line = curve(points[k]) + part * (curve(points[k + 1]) - curve(points[k]));
      largest = std::max(largest, std::abs(curve(theta) - line));
    }
  }
  return largest;
}

TEST(StraightLines, AParabolaHasEquallyManyLinesAsItsCurvatureAsks) {
  StraightLines lines;
  const auto parabola = [](double theta) { return theta * theta; };
  const auto columns = [&](double theta, double* value) { *value = parabola(theta); };
  // A line over h is h^2 / 4 away: at least 1 / sqrt(4 tolerance) lines.
  for (const double tolerance : {1e-2, 1e-3, 1e-5}) {
    const auto points = lines.points(columns, 1.0, 2, {tolerance});
    EXPECT_LE(largest_distance(parabola, points, 1.0), tolerance);
    EXPECT_LE(static_cast<double>(points.size()), 1.0 + 1.5 / std::sqrt(4.0 * tolerance));
  }
  EXPECT_TRUE(lines.points(columns, 1.0, 2, {0.3}).empty());
}

TEST(StraightLines, ACubicThatPassesTheMiddleOfItsChordIsSeen) {
  StraightLines lines;
  const auto cubic = [](double theta) { return theta * (theta - 0.5) * (theta - 1.0); };
  const auto points = lines.points([&](double theta, double* value) { *value = cubic(theta); }, 1.0, 2, {1e-3});
  EXPECT_LE(largest_distance(cubic, points, 1.0), 1e-3);
}

TEST(StraightLines, PeriodsAreDrawnAndThePartBehindTheEndIsNot) {
  StraightLines lines;
  const auto sine = [](double theta) { return std::sin(20.0 * theta); };
  const auto points = lines.points([&](double theta, double* value) { *value = sine(theta); }, 0.7, 8, {1e-3});
  EXPECT_LE(largest_distance(sine, points, 0.7), 1e-3);
  EXPECT_LT(points.back(), 0.7);
}

TEST(StraightLines, TheWorstColumnDecidesAndWhatIsNotFiniteDoesNot) {
  StraightLines lines;
  const auto columns = [](double theta, double* value) {
    value[0] = theta;
    value[1] = theta * theta;
    value[2] = std::numeric_limits<double>::quiet_NaN();
  };
  const std::vector<double> tolerance{1e-3, 1e-3, 1e-3};
  EXPECT_GE(lines.points(columns, 1.0, 2, tolerance).size(), 15U);
  EXPECT_TRUE(lines.points(columns, 1.0, 2, {1e-3, 1.0, 1e-3}).empty());
}

TEST(ColumnRanges, AreThoseOfTheValuesAndNotBelowTheFloor) {
  ColumnRanges ranges(2, 1e-3, {1e-6, 1e-8});
  EXPECT_EQ(ranges.tolerance(0), 1e-8);
  ranges.widen(0, -1.0);
  ranges.widen(0, 3.0);
  ranges.widen(0, std::numeric_limits<double>::infinity());
  EXPECT_DOUBLE_EQ(ranges.tolerance(0), 4e-3);
  ranges.widen(1, 1000.0);
  EXPECT_DOUBLE_EQ(ranges.tolerance(1), 1e-3 + 1e-8);
}

}  // namespace
}  // namespace saltus::ode
