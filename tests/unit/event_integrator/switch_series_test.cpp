// When switches that follow each other are said to have come to a limit.
#include "saltus/event_integrator/accumulate/switch_series.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "../precision.hpp"

namespace saltus::event_integrator {
namespace {

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
