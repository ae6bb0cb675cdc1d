// Limits of sequences of switches: geometric ones, and what has none.
#include "saltus/fesd_integrator/accumulate/cycle_series.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace saltus::fesd_integrator {
namespace {

/// Cycles of two switches around t = 3, x = (1, -2), that shrink by `ratio`, from durations of 1.
CycleSeries::Switch nth(int k, double ratio) {
  const double rest = std::pow(ratio, 0.5 * k);
  return {3.0 - rest / (1.0 - ratio),
          k % 2 == 0 ? std::vector{1, -1} : std::vector{-1, -1},
          {1.0 + 0.3 * rest, -2.0 - rest}};
}

TEST(CycleSeries, FindsTheLimitOfGeometricCycles) {
  for (const double ratio : {0.1, 0.5, 0.9}) {
    CycleSeries series;
    std::optional<CycleSeries::Limit> limit;
    int k = 0;
    for (; k < 2000 && !limit; ++k) {
      series.add(nth(k, ratio));
      limit = series.limit(CycleSeries::Wanted::resolved);
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

TEST(CycleSeries, AsksForNothingMoreWhereCyclesAreUnresolved) {
  CycleSeries series;
  for (int k = 0; k < 12; ++k) {
    auto next = nth(k, 0.5);
    next.resolution = 1e-4;
    series.add(std::move(next));
    // The last cycle takes 2^(1 - k/2): below a thousand times the resolution from k = 9 on.
    EXPECT_EQ(series.limit(CycleSeries::Wanted::resolved).has_value(), k >= 9) << k;
  }
}

TEST(CycleSeries, SoonIsBeforeItIsResolved) {
  CycleSeries series;
  for (int k = 0; k < 12; ++k) series.add(nth(k, 0.5));
  EXPECT_FALSE(series.limit(CycleSeries::Wanted::resolved).has_value());
  const auto limit = series.limit(CycleSeries::Wanted::soon);
  ASSERT_TRUE(limit.has_value());
  EXPECT_NEAR(limit->t, 3.0, 1e-12);
}

TEST(CycleSeries, CyclesThatDoNotShrinkHaveNone) {
  CycleSeries equal, growing, slowing;
  for (int k = 0; k < 60; ++k) {
    const std::vector<int> modes{k % 2};
    equal.add({0.1 * k, modes, {0.0}});
    growing.add({std::pow(1.1, k), modes, {0.0}});
    slowing.add({std::log(1.0 + k), modes, {0.0}});  // shrinks, but not geometrically: to infinity
  }
  for (const auto* series : {&equal, &growing, &slowing}) {
    EXPECT_FALSE(series->limit(CycleSeries::Wanted::resolved).has_value());
    EXPECT_FALSE(series->limit(CycleSeries::Wanted::soon).has_value());
  }
}

}  // namespace
}  // namespace saltus::fesd_integrator
