// Limits of sequences of switches: geometric ones, and what has none.
#include "saltus/fesd_integrator/accumulate/lap_series.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace saltus::fesd_integrator {
namespace {

/// Laps of two switches around t = 3, x = (1, -2), that shrink by `ratio`, from durations of 1.
LapSeries::Switch nth(int k, double ratio) {
  const double rest = std::pow(ratio, 0.5 * k);
  return {3.0 - rest / (1.0 - ratio),
          k % 2 == 0 ? std::vector{1, -1} : std::vector{-1, -1},
          {1.0 + 0.3 * rest, -2.0 - rest}};
}

TEST(LapSeries, FindsTheLimitOfGeometricLaps) {
  for (const double ratio : {0.1, 0.5, 0.9}) {
    LapSeries series;
    std::optional<LapSeries::Limit> limit;
    int k = 0;
    for (; k < 2000 && !limit; ++k) {
      series.add(nth(k, ratio));
      limit = series.limit(LapSeries::Wanted::resolved);
    }
    ASSERT_TRUE(limit.has_value()) << ratio;
    // What remained was below 1e-8 of the whole; extrapolation takes more than a fiftieth off that.
    const double whole = 1.0 / (1.0 - ratio);
    EXPECT_LE(std::pow(ratio, 0.5 * (k - 1)) / (1.0 - ratio), 1.001e-8 * whole) << ratio;
    EXPECT_NEAR(limit->t, 3.0, 2e-10 * whole) << ratio;
    EXPECT_NEAR(limit->x[0], 1.0, 1e-9) << ratio;
    EXPECT_NEAR(limit->x[1], -2.0, 1e-9) << ratio;
    EXPECT_EQ(limit->modes.size(), 2u);
  }
}

TEST(LapSeries, AsksForNothingMoreWhereLapsDrown) {
  LapSeries series;
  for (int k = 0; k < 12; ++k) {
    auto next = nth(k, 0.5);
    next.resolution = 1e-4;
    series.add(std::move(next));
    // The last lap takes 2^(1 - k/2): below a thousand times the resolution from k = 9 on.
    EXPECT_EQ(series.limit(LapSeries::Wanted::resolved).has_value(), k >= 9) << k;
  }
}

TEST(LapSeries, SoonIsBeforeItIsResolved) {
  LapSeries series;
  for (int k = 0; k < 12; ++k) series.add(nth(k, 0.5));
  EXPECT_FALSE(series.limit(LapSeries::Wanted::resolved).has_value());
  const auto limit = series.limit(LapSeries::Wanted::soon);
  ASSERT_TRUE(limit.has_value());
  EXPECT_NEAR(limit->t, 3.0, 1e-12);
}

TEST(LapSeries, LapsThatDoNotShrinkHaveNone) {
  LapSeries equal, growing, slowing;
  for (int k = 0; k < 60; ++k) {
    const std::vector<int> modes{k % 2};
    equal.add({0.1 * k, modes, {0.0}});
    growing.add({std::pow(1.1, k), modes, {0.0}});
    slowing.add({std::log(1.0 + k), modes, {0.0}});  // shrinks, but not geometrically: to infinity
  }
  for (const auto* series : {&equal, &growing, &slowing}) {
    EXPECT_FALSE(series->limit(LapSeries::Wanted::resolved).has_value());
    EXPECT_FALSE(series->limit(LapSeries::Wanted::soon).has_value());
  }
}

}  // namespace
}  // namespace saltus::fesd_integrator
