// Switches of two trajectories compared.
#include <gtest/gtest.h>

#include "saltus/pipeline/optimal_control/switch_comparison_internal.hpp"

namespace saltus::pipeline {
namespace {

using Switches = std::vector<Switch>;
const std::vector<double> two_intervals{0.0, 1.0, 2.0};
constexpr double at_ends = 1e-3;

Switch up(double t, std::size_t place = 0) { return {t, place, "-1", "1"}; }
Switch down(double t, std::size_t place = 0) { return {t, place, "1", "-1"}; }

void expect(const SwitchComparison& found, double time_error, int missed, int extra) {
  EXPECT_NEAR(found.time_error, time_error, 1e-15);
  EXPECT_EQ(found.missed, missed);
  EXPECT_EQ(found.extra, extra);
}

TEST(SwitchComparisonTest, SameSwitchesHaveErrorsOfTime) {
  expect(compare_switches(two_intervals, {{up(0.5), down(0.75)}, {up(1.5)}}, {up(0.5), down(0.625), up(1.5)}, at_ends),
         0.125, 0, 0);
}

TEST(SwitchComparisonTest, MissedAndExtraOnes) {
  expect(compare_switches(two_intervals, {{up(0.5)}, {}}, {}, at_ends), 0.0, 1, 0);
  expect(compare_switches(two_intervals, {{}, {}}, {up(0.5)}, at_ends), 0.0, 0, 1);
  expect(compare_switches(two_intervals, {{up(0.5)}, {}}, {down(0.5)}, at_ends), 0.0, 1, 1);
  expect(compare_switches(two_intervals, {{up(0.5)}, {}}, {up(0.5, 2)}, at_ends), 0.0, 1, 1);
}

TEST(SwitchComparisonTest, OtherIntervalsAreOtherSwitches) {
  expect(compare_switches(two_intervals, {{up(0.9)}, {}}, {up(1.1)}, at_ends), 0.0, 1, 1);
}

TEST(SwitchComparisonTest, TheNearestOfEqualOnesIsTaken) {
  const Switches simulated{up(0.125), down(0.25), up(0.5), down(0.625)};
  expect(compare_switches(two_intervals, {simulated, {}}, {up(0.53125), down(0.625)}, at_ends), 0.03125, 2, 0);
}

TEST(SwitchComparisonTest, AsManyAsPossibleArePaired) {
  const Switches simulated{up(0.5), down(0.6)};
  expect(compare_switches(two_intervals, {simulated, {}}, {up(0.1), down(0.2), up(0.5)}, at_ends), 0.4, 0, 1);
}

TEST(SwitchComparisonTest, EndsOfIntervalsBelongToBothSides) {
  expect(compare_switches(two_intervals, {{up(0.9996)}, {}}, {up(1.0004)}, at_ends), 0.0008, 0, 0);
  expect(compare_switches(two_intervals, {{}, {up(1.0)}}, {up(0.9995)}, at_ends), 0.0005, 0, 0);
  // Separate simulations from both sides pass it twice, or never.
  expect(compare_switches(two_intervals, {{up(0.9996)}, {up(1.0001)}}, {up(0.9996)}, at_ends), 0.0, 0, 0);
  expect(compare_switches(two_intervals, {{}, {}}, {up(1.0)}, at_ends), 0.0, 0, 0);
  expect(compare_switches(two_intervals, {{}, {}}, {up(0.0), up(2.0)}, at_ends), 0.0, 0, 0);
}

TEST(SwitchComparisonTest, FunctionsThatChangeTogetherAreOneEach) {
  result::Event both;
  both.t = 0.5;
  both.mode_before = {-1, 0, 1};
  both.mode_after = {1, 0, -1};
  both.regions_before = {{"a"}, {"c", "b"}};
  both.regions_after = {{"a"}, {"c"}};
  const auto switches = switches_of({both}, {true, true, true});
  ASSERT_EQ(switches.size(), 3U);
  EXPECT_EQ(switches[0].place, 0U);
  EXPECT_EQ(switches[1].place, 4U);
  EXPECT_EQ(switches[2].place, 3U);
  EXPECT_EQ(switches[2].from, "b c");
  EXPECT_EQ(switches_of({both}, {false, true, true}).size(), 2U);
  // In another order, as rounding puts them.
  expect(compare_switches(two_intervals, {switches, {}}, {down(0.5, 4), {0.5, 3, "b c", "c"}, up(0.5)}, at_ends), 0.0,
         0, 0);
}

TEST(SwitchComparisonTest, EventsWithoutAChangeOfModeAreNone) {
  result::Event start, user;
  start.mode_after = {1};
  user.mode_before = user.mode_after = {1};
  EXPECT_TRUE(switches_of({start, user}, {true}).empty());
}

}  // namespace
}  // namespace saltus::pipeline
