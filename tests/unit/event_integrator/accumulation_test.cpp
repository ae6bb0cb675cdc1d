// Limits of sequences of jumps: geometric ones, chattering, and what has none.
#include "saltus/event_integrator/accumulate/accumulation.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

namespace saltus::event_integrator {
namespace {

/// Cycles of jumps 2 and 0 around t = 3, x = (1, -2), that shrink by `ratio`, from durations of 1.
void add_nth(int k, double ratio, EventSeries& series) {
  const double rest = std::pow(ratio, 0.5 * k);
  series.add(3.0 - rest / (1.0 - ratio), {k % 2 == 0 ? 2 : 0}, {1.0 + 0.3 * rest, -2.0 - rest});
}

TEST(LastItems, KeepsTheLastOnesInTheirOrder) {
  LastItems<int, 3> items;
  EXPECT_TRUE(items.empty());
  for (int k = 0; k < 8; ++k) {
    items.append() = k;
    EXPECT_EQ(items.back(0), k);
    EXPECT_EQ(items.front(), std::max(k - 2, 0));
  }
  EXPECT_EQ(items.back(1), 6);
  items.clear();
  items.append() = 10;
  items.append() = 11;
  EXPECT_EQ(items.size(), 2u);
  EXPECT_EQ(items.front(), 10);
}

TEST(EventSeries, FindsTheLimitOfGeometricCycles) {
  for (const double ratio : {0.1, 0.5, 0.9}) {
    EventSeries series;
    std::optional<SeriesLimit> limit;
    int k = 0;
    for (; k < 2000 && !limit; ++k) {
      add_nth(k, ratio, series);
      EXPECT_EQ(series.shrinks(), k >= 5) << k;  // the durations of three cycles
      limit = series.limit({0.0, 0.0, 0.0});
    }
    ASSERT_TRUE(limit.has_value()) << ratio;
    const double whole = 1.0 / (1.0 - ratio);
    EXPECT_NEAR(limit->t, 3.0, 2e-10 * whole) << ratio;
    EXPECT_NEAR(limit->x[0], 1.0, 1e-9) << ratio;
    EXPECT_NEAR(limit->x[1], -2.0, 1e-9) << ratio;
    EXPECT_EQ(limit->events, (std::vector<int>{0, 2}));
    EXPECT_EQ(limit->kind, SeriesKind::cycles);
  }
}

TEST(EventSeries, CyclesThatDoNotShrinkHaveNoLimit) {
  EventSeries series;
  for (int k = 0; k < 400; ++k) {
    series.add(0.1 * k, {k % 2}, {1.0});
    EXPECT_FALSE(series.limit({0.0, 0.0}));
    EXPECT_FALSE(series.nearly());
  }
  ASSERT_TRUE(series.closed_cycle().has_value());
  EXPECT_NEAR(*series.closed_cycle(), 0.2, 1e-12);
}

TEST(EventSeries, ChatteringIsWhereItIsAndGoesOnThroughRests) {
  EventSeries series;
  std::optional<SeriesLimit> limit;
  int k = 0;
  // Faster than a hundredth of what their guards resolve, and in no order.
  for (; k < 200 && !limit; ++k) {
    series.add(1.0 + 1e-9 * k, {(k * k / 3) % 3}, {5.0});
    if (k == 40) series.clear_cycles();
    limit = series.limit({1e-6, 1e-6, 1e-6});
  }
  ASSERT_TRUE(limit.has_value());
  EXPECT_EQ(k, 64);
  EXPECT_EQ(limit->kind, SeriesKind::chattering);
  EXPECT_EQ(limit->t, 1.0 + 1e-9 * (k - 1));
  EXPECT_EQ(limit->x, (std::vector<double>{5.0}));
  series.clear();
  EXPECT_TRUE(series.empty());
  EXPECT_FALSE(series.limit({1e-6, 1e-6, 1e-6}));
}

}  // namespace
}  // namespace saltus::event_integrator
