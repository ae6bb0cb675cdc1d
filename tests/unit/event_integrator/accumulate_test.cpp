// Limits of sequences of jumps and of switches.
#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "../precision.hpp"
#include "saltus/event_integrator/accumulate/accumulation.hpp"
#include "saltus/event_integrator/accumulate/switch_series.hpp"

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
      EXPECT_EQ(series.shrinks(), k >= 4) << k;  // behind two cycles
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
  // Faster than a hundredth of what their guards resolve, in no order, and never faster.
  std::mt19937 random(20261127);
  const double interval = std::ldexp(1.0, -30);
  for (; k < 200 && !limit; ++k) {
    series.add(1.0 + interval * k, {static_cast<int>(random() % 3)}, {5.0});
    if (k == 40) series.clear_cycles();
    limit = series.limit({1e-6, 1e-6, 1e-6});
  }
  ASSERT_TRUE(limit.has_value());
  EXPECT_EQ(k, 64);
  EXPECT_EQ(limit->kind, SeriesKind::chattering);
  EXPECT_EQ(limit->t, 1.0 + interval * (k - 1));
  EXPECT_EQ(limit->x, (std::vector<double>{5.0}));
  series.clear();
  EXPECT_TRUE(series.empty());
  EXPECT_FALSE(series.limit({1e-6, 1e-6, 1e-6}));
}

TEST(SwitchSeries, CyclesThatHalveUntilNoModelLivesThereHaveALimit) {
  SwitchSeries series(10.0);
  double cycle = 1e-10;
  double t = 1.0;
  for (int k = 0; k < 8; ++k, cycle *= 0.5) series.note(t += cycle, {.surface = 0, .before = k % 2 == 0 ? 1 : -1});
  EXPECT_TRUE(series.shrinks(t));
}

TEST(SwitchSeries, CyclesThatTimeDoesNotResolveHaveALimitHoweverTheyAreRounded) {
  SwitchSeries series(10.0);
  const double cycles[] = {1.0, 0.1, 20.0 * epsilon, 24.0 * epsilon, 20.0 * epsilon, 24.0 * epsilon};
  double t = 4.0;
  for (const double cycle : cycles) series.note(t += 4.0 * cycle, {.surface = 0, .before = 1});
  EXPECT_TRUE(series.shrinks(t));
}

TEST(SwitchSeries, CyclesOfOneLengthThatTimeResolvesHaveNone) {
  SwitchSeries series(10.0);
  double t = 4.0;
  for (int k = 0; k < 20; ++k) series.note(t += 1e-11, {.surface = 0, .before = 1});
  EXPECT_FALSE(series.shrinks(t));
}

TEST(SwitchSeries, CyclesThatShrinkALittleAreTakenForASpiralOnceTheyHaveHalved) {
  SwitchSeries series(10.0);
  constexpr double q = 0.9995;
  double t = 0.0;
  double cycle = 1e-3;
  int before = 0;
  for (; before < 5000 && !series.tightens(); ++before, cycle *= q)
    series.note(t += cycle, {.surface = 0, .before = 1});
  // Two cycles of four to tell that they shrink, and ln(1/2)/ln(q) switches from the first of them.
  EXPECT_NEAR(before, 8 + std::log(0.5) / std::log(q), 8.0);
}

TEST(SwitchSeries, CyclesThatShrinkToALengthAreALimitCycle) {
  SwitchSeries series(10.0);
  double t = 0.0;
  double more = 5e-4;
  for (int k = 0; k < 20000; ++k, more *= 0.9995) {
    series.note(t += 1e-3 + more, {.surface = 0, .before = 1});
    EXPECT_FALSE(series.tightens());
  }
}

}  // namespace
}  // namespace saltus::event_integrator
