#include "saltus/base/stop.hpp"

#include <gtest/gtest.h>

namespace saltus {
namespace {

constexpr auto at_once = StopScope::Clock::duration::zero();

TEST(Stop, NobodyIsAskedOutsideOfAScope) { EXPECT_NO_THROW(heed_stop()); }

TEST(Stop, ALoopEndsWhereAStopIsWanted) {
  int rounds = 0;
  const StopScope scope([&] { return rounds == 3; }, at_once);
  EXPECT_THROW(
      while (true) {
        heed_stop();
        ++rounds;
      },
      Stopped);
  EXPECT_EQ(rounds, 3);
}

TEST(Stop, TheInnerScopeCountsAsLongAsItLives) {
  const StopScope outer([] { return true; }, at_once);
  {
    const StopScope inner([] { return false; }, at_once);
    EXPECT_NO_THROW(heed_stop());
  }
  EXPECT_THROW(heed_stop(), Stopped);
}

TEST(Stop, IsAskedForOnceInAPause) {
  int asked = 0;
  const StopScope scope([&] { return ++asked > 1; }, std::chrono::hours(1));
  for (int i = 0; i < 1000; ++i) EXPECT_NO_THROW(heed_stop());
  EXPECT_EQ(asked, 0);
}

}  // namespace
}  // namespace saltus
