#include "saltus/event_integrator/mode/mode_log.hpp"

#include <cmath>
#include <limits>
#include <random>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace saltus::event_integrator {
namespace {

using State = std::pair<std::vector<int>, std::vector<double>>;

/// Modes of `n` surfaces, of which one or two change from each to the next.
std::vector<State> random_history(std::size_t n, std::size_t length) {
  std::mt19937 random(20260);
  State state{std::vector<int>(n, 1), std::vector<double>(n, 1.0)};
  std::vector<State> history{state};
  while (history.size() < length) {
    for (int k = 0; k < 2; ++k) {
      const std::size_t j = random() % n;
      state.first[j] = static_cast<int>(random() % 3) - 1;
      state.second[j] =
          state.first[j] == 0 ? std::ldexp(static_cast<double>(random()), -32) : 0.5 + 0.5 * state.first[j];
    }
    if (state != history.back()) history.push_back(state);
  }
  return history;
}

TEST(ModeLog, GivesBackWhatWasAppendedInAnyOrder) {
  for (const std::size_t n : {1U, 5U, 31U, 32U, 33U, 200U}) {
    const auto history = random_history(n, 40);
    ModeLog log;
    for (std::size_t k = 0; k < history.size(); ++k) EXPECT_EQ(log.append(history[k].first, history[k].second), k);
    ASSERT_EQ(log.size(), history.size());
    ModeLog::Reader reader(log);
    const auto expect = [&](std::size_t k) {
      reader.seek(k);
      EXPECT_EQ(reader.mode(), history[k].first) << n << " surfaces, mode " << k;
      EXPECT_EQ(reader.alpha(), history[k].second) << n << " surfaces, mode " << k;
    };
    for (std::size_t k = 0; k < history.size(); k += 3) expect(k);
    for (std::size_t k = history.size(); k-- > 0;) expect(k);
  }
}

TEST(ModeLog, TheSameModeAgainIsNoNewOne) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  ModeLog log;
  EXPECT_EQ(log.append({1, 0}, {1.0, nan}), 0U);
  EXPECT_EQ(log.append({1, 0}, {1.0, nan}), 0U);
  EXPECT_EQ(log.append({1, 0}, {1.0, 0.25}), 1U);
  EXPECT_EQ(log.append({1, 0}, {1.0, 0.25}), 1U);
  EXPECT_EQ(log.append({1, 0}, {1.0, nan}), 2U);
  EXPECT_EQ(log.size(), 3U);
}

TEST(ModeLog, KnowsWhichModesChangedLast) {
  ModeLog log;
  std::vector<std::size_t> changed;
  log.append({1, 0, -1}, {1.0, 0.5, 0.0});
  log.append_changed(changed);
  EXPECT_TRUE(changed.empty());
  log.append({-1, 0, 0}, {0.0, 0.75, 0.5});  // of the second one only the selection
  log.append_changed(changed);
  EXPECT_EQ(changed, (std::vector<std::size_t>{0, 2}));
}

TEST(ModeLog, TakesChangesOfFunctionsOneOrTwoAtATime) {
  ModeLog log;
  log.append({1, 0, -1}, {1.0, 0.5, 0.0});
  EXPECT_EQ(log.append_change(1, 0, 0.75), 1U);
  EXPECT_EQ(log.append_change(1, 0, 0.75), 1U) << "no change";
  EXPECT_EQ(log.append_changes({{{2, 1, 1.0}, {1, 0, 0.25}}}), 2U);
  std::vector<std::size_t> changed;
  log.append_changed(changed);
  EXPECT_EQ(changed, (std::vector<std::size_t>{2}));
  ModeLog::Reader reader(log);
  reader.seek(2);
  EXPECT_EQ(reader.mode(), (std::vector<int>{1, 0, 1}));
  EXPECT_EQ(reader.alpha(), (std::vector<double>{1.0, 0.25, 1.0}));
  reader.seek(1);
  EXPECT_EQ(reader.mode(), (std::vector<int>{1, 0, -1}));
  EXPECT_EQ(reader.alpha(), (std::vector<double>{1.0, 0.75, 0.0}));
}

TEST(ModeLog, WorksWithoutSurfaces) {
  ModeLog log;
  EXPECT_EQ(log.append({}, {}), 0U);
  EXPECT_EQ(log.append({}, {}), 0U);
  ModeLog::Reader reader(log);
  reader.seek(0);
  EXPECT_TRUE(reader.mode().empty());
}

}  // namespace
}  // namespace saltus::event_integrator
