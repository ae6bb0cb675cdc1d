// What is at rest behind the limit of jumps: moving walls, several guards at once, release. References are closed
// forms.
#include <cmath>
#include <numbers>
#include <string>

#include <gtest/gtest.h>

#include "agreement/jumps.hpp"

namespace saltus::problems {
namespace {

void expect_message(const Result& result, const std::string& part) {
  EXPECT_EQ(result.status.termination, Termination::outside_class);
  EXPECT_NE(result.status.message.find(part), std::string::npos) << result.status.message;
}

/// A free ball at x = 1 before a wall at t^2/2 whose impacts halve the relative speed.
std::string pushed_ball(const std::string& rate_of_v, const std::string& more) {
  return R"toml(
[parameters]
zero = 0
[states]
x = 1
v = 0
[dynamics]
x = "v"
v = ")toml" +
         rate_of_v + R"toml("
[[jumps]]
name = "hit"
when = "x - t^2/2"
direction = "down"
set = { v = "t - (v - t)/2" }
[simulate]
until = 10
)toml" + more;
}

// Seen from the wall it falls from 1 with gravity 1: sqrt(2) (1 + e)/(1 - e).
TEST(Rest, AFreeBallGoesWithAWallThatPushesIt) {
  for (const auto& accuracy : {standard, fine, implicit}) {
    const Result result = simulated(pushed_ball("0", ""), accuracy);
    ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
    const auto limits = limits_of(result);
    ASSERT_EQ(limits.size(), 1U);
    EXPECT_NEAR(limits[0].t, 3 * std::numbers::sqrt2, 3e-9 * std::numbers::sqrt2);
    EXPECT_NEAR(result.final.x[0], 50.0, 1e-13);
    EXPECT_NEAR(result.final.x[1], 10.0, 1e-14);
  }
}

// The wall at 1 - cos t pushes until t = pi/2; the ball flies on with the speed 1.
TEST(Rest, AFreeBallLeavesAWallThatBrakes) {
  for (const auto& accuracy : {standard, fine, implicit}) {
    const Result result = simulated(R"toml(
[states]
x = 0
v = 0
[dynamics]
x = "v"
v = "0"
[[jumps]]
when = "x - 1 + cos(t)"
direction = "down"
set = { v = "sin(t)" }
[simulate]
until = 3
)toml",
                                    accuracy);
    ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
    const double release = std::numbers::pi / 2;
    EXPECT_NEAR(result.final.x[0], 1 + (3 - release), 1e-8);
    EXPECT_NEAR(result.final.x[1], 1, 1e-8);
  }
}

// Comparisons of a state of rate 0 are read at jumps only, which does not do while it is carried along.
TEST(Rest, AStateThatIsReadAtJumpsOnlyIsNotCarriedAlong) {
  const std::string compared = "[outputs]\nfast = \"if(v > 5, 1, 0)\"\n";
  expect_message(simulated(pushed_ball("0", compared)), "'v-5' is read at jumps only");
  expect_message(simulated(pushed_ball("0", "[[jumps]]\nname = \"count\"\nwhen = \"v > 5\"\nset = { v = \"v\" }\n")),
                 "'count' is read at jumps only");
  const Result moving = simulated(pushed_ball("zero", compared));
  ASSERT_EQ(moving.status.termination, Termination::completed) << moving.status.message;
  EXPECT_EQ(moving.events.back().kind, EventKind::crossing);
  EXPECT_NEAR(moving.events.back().t, 5, 1e-11);
}

// Walls at ±(1 - t/10) meet at t = 10, with the ball between them.
TEST(Rest, NothingRestsBetweenWallsThatMeet) {
  const Result result = simulated(R"toml(
[states]
x = 0
v = 1
[dynamics]
x = "v"
v = "0"
[[jumps]]
name = "right"
when = "1 - t/10 - x"
direction = "down"
set = { v = "-0.8*v - 0.18" }
[[jumps]]
name = "left"
when = "x + 1 - t/10"
direction = "down"
set = { v = "-0.8*v + 0.18" }
[simulate]
until = 12
)toml");
  expect_message(result, "cannot be at rest at 0 together");
  ASSERT_EQ(limits_of(result).size(), 1U);
  EXPECT_NEAR(limits_of(result)[0].t, 10, 1e-8);
}

// The numbers of the taps could be made to fit; their jumps do not.
TEST(Rest, AJumpThatGoesOnAtRestHoldsNothing) {
  const Result result = simulated(R"toml(
[states]
x1 = 1
x2 = 1
tap = 1.5
second = 0
[dynamics]
x1 = "tap - 1"
x2 = "second - 1"
tap = "0"
second = "0"
[[jumps]]
name = "to2"
when = "x2"
direction = "down"
set = { tap = "0", second = "1.5" }
[[jumps]]
name = "to1"
when = "x1"
direction = "down"
set = { tap = "1.5", second = "0" }
[simulate]
until = 30
)toml");
  expect_message(result, "cannot be at rest at 0 together");
  EXPECT_NEAR(limits_of(result).at(0).t, 4, 4e-9);
}

// A jump that counts has the guard of the one that reflects: it rests with it, and leaves with it. The second guard is
// twice the first: one of them is held.
TEST(Rest, JumpsThatShareAGuardRestTogether) {
  for (const auto& accuracy : {standard, fine, implicit}) {
    const Result result = simulated(R"toml(
[states]
y = 1
v = 0
n = 0
[dynamics]
y = "v"
v = "-10 + 2*max(t - 3, 0)"
n = "0"
[[jumps]]
name = "count"
when = "y"
direction = "down"
set = { n = "n + 1" }
[[jumps]]
name = "bounce"
when = "2*y"
direction = "down"
set = { v = "-v/2" }
[simulate]
until = 9
)toml",
                                    accuracy);
    ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
    ASSERT_EQ(limits_of(result).size(), 1U);
    EXPECT_EQ(limits_of(result)[0].surfaces, (std::vector<std::string>{"count", "bounce"}));
    EXPECT_NEAR(limits_of(result)[0].t, 3 * std::sqrt(0.2), 1e-9);
    // Pressed on until t = 8, then y'' = 2 (t - 8).
    EXPECT_NEAR(result.final.x[0], 1.0 / 3.0, 1e-8);
    EXPECT_NEAR(result.final.x[1], 1, 1e-8);
    EXPECT_EQ(result.final.x[2], static_cast<double>(jumps_of(result, "count").size()));
    EXPECT_EQ(jumps_of(result, "count").size(), jumps_of(result, "bounce").size());
  }
}

// Ends and middle of a plate, three guards of two degrees of freedom: at rest all stand. From t = 3 on the middle is
// pulled up with 20 (t - 3): it presses on nothing from t = 3.5 on.
TEST(Rest, APlateStandsOnThreeLegs) {
  for (const auto& accuracy : {standard, fine, implicit}) {
    const Result result = simulated(R"toml(
[states]
y = 1
a = 0.1
v = 0
w = 0
[dynamics]
y = "v"
a = "w"
v = "-10 + 20*max(t - 3, 0)"
w = "0"
[[jumps]]
name = "leg1"
when = "y - a"
direction = "down"
set = { v = "v - 0.6*(v - w)", w = "w + 0.6*(v - w)" }
[[jumps]]
name = "leg2"
when = "y + a"
direction = "down"
set = { v = "v - 0.6*(v + w)", w = "w - 0.6*(v + w)" }
[[jumps]]
name = "middle"
when = "y"
direction = "down"
set = { v = "-0.2*v" }
[simulate]
until = 4
output = { times = [2.5, 4] }
)toml",
                                    accuracy);
    ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
    EXPECT_FALSE(limits_of(result).empty());
    const auto& rows = result.trajectory;
    for (std::size_t k = 0; k < rows.t.size(); ++k) {
      if (rows.t[k] != 2.5) continue;
      for (const double x : rows.x[k]) EXPECT_NEAR(x, 0, 1e-15);
    }
    // y'' = 20 (t - 3.5) from there on.
    EXPECT_NEAR(result.final.x[0], 20.0 / 6.0 / 8.0, 1e-8);
    EXPECT_NEAR(result.final.x[1], 0, 1e-8);
    EXPECT_NEAR(result.final.x[2], 2.5, 1e-8);
  }
}

}  // namespace
}  // namespace saltus::problems
