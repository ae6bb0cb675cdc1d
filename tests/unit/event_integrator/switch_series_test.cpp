// When switches that follow each other are said to have come to a limit.
#include "saltus/event_integrator/switch_series.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "../precision.hpp"

namespace saltus::event_integrator {
namespace {

TEST(SwitchSeries, LapsThatHalveUntilNoModelLivesThereHaveALimit) {
  SwitchSeries series(10.0);
  double lap = 1e-10;
  double t = 1.0;
  for (int k = 0; k < 8; ++k, lap *= 0.5) series.note(t += lap, 0, k % 2 == 0 ? 1 : -1);
  EXPECT_TRUE(series.shrinks(t));
}

TEST(SwitchSeries, LapsThatTimeDoesNotResolveHaveALimitHoweverTheyAreRounded) {
  SwitchSeries series(10.0);
  const double laps[] = {1.0, 0.1, 20.0 * epsilon, 24.0 * epsilon, 20.0 * epsilon, 24.0 * epsilon};
  double t = 4.0;
  for (const double lap : laps) series.note(t += 4.0 * lap, 0, 1);
  EXPECT_TRUE(series.shrinks(t));
}

TEST(SwitchSeries, LapsOfOneLengthThatTimeResolvesHaveNone) {
  SwitchSeries series(10.0);
  double t = 4.0;
  for (int k = 0; k < 20; ++k) series.note(t += 1e-11, 0, 1);
  EXPECT_FALSE(series.shrinks(t));
}

}  // namespace
}  // namespace saltus::event_integrator
