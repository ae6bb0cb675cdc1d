// Jumps that accumulate: the limit, rest on the guard, release. References are closed forms.
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "agreement/jumps.hpp"

namespace saltus::problems {
namespace {

// The first fall takes 10/7; the impacts accumulate at 10/7 (1 + e)/(1 - e).
TEST(Zeno, BouncingBallsComeToRestAtTheLimit) {
  for (const auto& accuracy : {standard, fine, implicit}) {
    for (const std::string e : {"0", "1e-12", "1e-5", "0.01", "0.3", "0.7", "0.9", "0.99"}) {
      const double restitution = std::stod(e);
      const double limit = 10.0 / 7.0 * (1 + restitution) / (1 - restitution);
      const Result result = simulated(ball(e, 300), accuracy);
      ASSERT_EQ(result.status.termination, Termination::completed) << "e = " << e << ": " << result.status.message;
      const auto limits = limits_of(result);
      ASSERT_EQ(limits.size(), 1U) << "e = " << e;
      EXPECT_NEAR(limits[0].t, limit, 1e-9 * limit) << "e = " << e;
      EXPECT_EQ(limits[0].surfaces, std::vector<std::string>{"bounce"});
      EXPECT_EQ(limits[0].x_after, (std::vector<double>{0.0, 0.0})) << "e = " << e;
      EXPECT_EQ(result.final.x, (std::vector<double>{0.0, 0.0})) << "e = " << e;
    }
  }
}

// Bounces are events as long as they can be told apart: what is left at the last one is below 1e-8 of the limit.
TEST(Zeno, NoBounceIsFoldedEarly) {
  const Result result = simulated(ball("0.9", 30), standard);
  const auto bounces = jumps_of(result);
  EXPECT_GT(limits_of(result)[0].t - bounces.back().t, 0.0);
  EXPECT_LT(limits_of(result)[0].t - bounces.back().t, 3e-7);
  double speed = 14.0;
  for (const auto& bounce : bounces) {
    speed *= 0.9;
    EXPECT_NEAR(bounce.x_after[1], speed, 1e-8 * speed + 1e-12);
  }
}

TEST(Zeno, TheRunMayEndBeforeTheLimit) {
  const Result result = simulated(ball("0.9", 27.1428), standard);
  EXPECT_EQ(result.status.termination, Termination::completed);
  EXPECT_TRUE(limits_of(result).empty());
}

// A ball at rest whose weight turns into lift at t = 2: y'' = 5 (t - 2) from there on.
TEST(Zeno, RestEndsWhereTheGuardIsPressedOutward) {
  const Result result = simulated(R"toml(
[states]
y = 0
v = 0
[dynamics]
y = "v"
v = "-10 + 5*t"
[[jumps]]
when = "y"
direction = "down"
set = { v = "-0.5*v" }
[simulate]
until = 3
)toml");
  ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
  ASSERT_EQ(result.events.size(),
            2U);  // the jump at the start, and that it is its own limit; the release is not listed
  EXPECT_EQ(result.events[1].kind, EventKind::accumulation);
  EXPECT_NEAR(result.final.x[0], 5.0 / 6.0, 1e-11);
  EXPECT_NEAR(result.final.x[1], 2.5, 1e-11);
}

// Ground that moves slowly: the ball rests on it, and goes with it.
TEST(Zeno, MovingGround) {
  for (const auto& accuracy : {standard, fine}) {
    const Result result = simulated(R"toml(
[states]
y = 1
v = 0
[dynamics]
y = "v"
v = "-9.81"
[[jumps]]
when = "y - 0.1*sin(3*t)"
direction = "down"
set = { v = "0.3*cos(3*t) - 0.5*(v - 0.3*cos(3*t))" }
[simulate]
until = 12
)toml",
                                    accuracy);
    ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
    EXPECT_EQ(limits_of(result).size(), 1U);
    EXPECT_NEAR(result.final.x[0], 0.1 * std::sin(36.0), 1e-15);
    EXPECT_NEAR(result.final.x[1], 0.3 * std::cos(36.0), 1e-15);
  }
}

// Each impact takes 3/20 of the change of v off the tangential speed u: altogether 0.225 v1/(1 - e). At rest gravity
// goes on with it: u' = 1 - 3/20 10.
TEST(Zeno, TheTangentialPartOfAJumpActsAtRest) {
  const Result result = simulated(R"toml(
[states]
x = 0
u = 4
y = 1
v = 0
[dynamics]
x = "u"
u = "1"
y = "v"
v = "-10"
[[jumps]]
when = "y"
direction = "down"
set = { v = "-0.5*v", u = "u + 0.15*1.5*v" }
[simulate]
until = 3
)toml");
  ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
  const auto limits = limits_of(result);
  ASSERT_EQ(limits.size(), 1U);
  const double impact = std::sqrt(20.0);
  EXPECT_NEAR(limits[0].t, 3 * std::sqrt(0.2), 1e-9);
  EXPECT_NEAR(limits[0].x_after[1], 4 + limits[0].t - 0.225 * impact * 2, 1e-9);
  EXPECT_NEAR(result.final.x[1], limits[0].x_after[1] - 0.5 * (3 - limits[0].t), 1e-9);
  EXPECT_EQ(result.final.x[2], 0.0);
}

// Two balls of radius 1/4 above each other: impacts in no regular order, in the end both rest.
TEST(Zeno, TwoBallsOnEachOther) {
  const Result result = simulated(R"toml(
[states]
y1 = 1
v1 = 0
y2 = 2
v2 = 0
[dynamics]
y1 = "v1"
v1 = "-10"
y2 = "v2"
v2 = "-10"
[[jumps]]
name = "ground"
when = "y1"
direction = "down"
set = { v1 = "-0.5*v1" }
[[jumps]]
name = "hit"
when = "y2 - y1 - 0.5"
direction = "down"
set = { v1 = "(v1 + v2)/2 - 0.25*(v1 - v2)", v2 = "(v1 + v2)/2 + 0.25*(v1 - v2)" }
[simulate]
until = 6
)toml",
                                  standard);
  ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
  const double rest[] = {0.0, 0.0, 0.5, 0.0};
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(result.final.x[i], rest[i], 1e-15);
  EXPECT_LT(result.events.size(), 1000U);
}

// A drag of v |v|/2: no closed form, but the limit does not depend on how it is computed.
TEST(Zeno, DragAgreesAcrossMethods) {
  std::vector<double> limits;
  for (const auto& accuracy : {Accuracy{pipeline::Integrator::dopri5, 1e-11, 1e-13}, fine,
                               Accuracy{pipeline::Integrator::radau5, 1e-11, 1e-13}}) {
    const Result result = simulated(R"toml(
[states]
y = 1
v = 0
[dynamics]
y = "v"
v = "-9.81 - 0.5*v*abs(v)"
[[jumps]]
when = "y < 0"
set = { v = "-0.8*v" }
[simulate]
until = 5
)toml",
                                    accuracy);
    ASSERT_EQ(limits_of(result).size(), 1U);
    limits.push_back(limits_of(result)[0].t);
    EXPECT_EQ(result.final.x, (std::vector<double>{0.0, 0.0}));
  }
  EXPECT_NEAR(limits[0], limits[1], 1e-9);
  EXPECT_NEAR(limits[2], limits[1], 1e-9);
}

// Two tanks with one tap: each drains at 1, the tap gives 3/2 to the one that runs empty. Together they hold out to t =
// 4; nothing is left to hold there.
TEST(Zeno, WhereNothingCanBeHeldTheRunEndsAtTheLimit) {
  const Result result = simulated(R"toml(
[states]
x1 = 1
x2 = 1
tap = 1
[dynamics]
x1 = "if(tap == 1, 1.5, 0) - 1"
x2 = "if(tap == 1, 0, 1.5) - 1"
tap = "0"
[[jumps]]
name = "to2"
when = "x2 < 0 and tap == 1"
set = { tap = "2" }
[[jumps]]
name = "to1"
when = "x1 < 0 and tap == 2"
set = { tap = "1" }
[simulate]
until = 30
)toml");
  EXPECT_EQ(result.status.termination, Termination::outside_class);
  ASSERT_EQ(limits_of(result).size(), 1U);
  EXPECT_NEAR(limits_of(result)[0].t, 4.0, 4e-9);
  EXPECT_EQ(limits_of(result)[0].surfaces, (std::vector<std::string>{"to2", "to1"}));
  EXPECT_NE(result.status.message.find("accumulate"), std::string::npos) << result.status.message;
}

}  // namespace
}  // namespace saltus::problems
