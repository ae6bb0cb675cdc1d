#include "saltus/base/preparation.hpp"

#include <thread>

#include <gtest/gtest.h>

namespace saltus {
namespace {

/// Long enough for a scope to be asked.
void pass_a_pause() { std::this_thread::sleep_for(StopScope::usual_pause + std::chrono::milliseconds(5)); }

TEST(Preparation, IsSaidInWords) {
  EXPECT_EQ((Preparation{"reading the model", 3, 20}).text(), "reading the model: 3 of 20");
  EXPECT_EQ((Preparation{"compiling the model"}).text(), "compiling the model");
}

TEST(Preparation, NobodyHearsOfItOutsideOfAScope) { EXPECT_NO_THROW(prepares("reading the model", 1, 2)); }

TEST(Preparation, WhoHearsOfItMayStopIt) {
  std::string heard;
  const PreparationScope scope([&](const Preparation& now) {
    heard = now.text();
    return now.done < 2;
  });
  pass_a_pause();
  EXPECT_NO_THROW(prepares("reading the model", 1, 2));
  EXPECT_EQ(heard, "reading the model: 1 of 2");
  EXPECT_NO_THROW(prepares("reading the model", 2, 2)) << "asked only once in a while";
  pass_a_pause();
  EXPECT_THROW(prepares("reading the model", 2, 2), Stopped);
}

TEST(Preparation, LoopsInsideSayWhatIsUnderWay) {
  std::string heard;
  const PreparationScope scope([&](const Preparation& now) {
    heard = now.text();
    return true;
  });
  prepares("solving for accelerations", 7, 9);
  pass_a_pause();
  heed_stop();
  EXPECT_EQ(heard, "solving for accelerations: 7 of 9");
}

TEST(Preparation, TheInnerScopeHearsOfItAsLongAsItLives) {
  int outer_heard = 0, inner_heard = 0;
  const PreparationScope outer([&](const Preparation&) { return ++outer_heard > 0; });
  {
    const PreparationScope inner([&](const Preparation&) { return ++inner_heard > 0; });
    pass_a_pause();
    prepares("reading the model");
  }
  pass_a_pause();
  prepares("reading the model");
  EXPECT_EQ(inner_heard, 1);
  EXPECT_EQ(outer_heard, 1);
}

}  // namespace
}  // namespace saltus
