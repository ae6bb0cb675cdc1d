// Dry friction in the direction of a wall at which a mass comes to rest: both hold its velocity, and what each of them
// takes is not determined. References are closed forms.
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "agreement/jumps.hpp"

namespace saltus::problems {
namespace {

/// What must not change the motion: the side of the wall, factors of the guard and of the law's argument.
struct Dress {
  double side = 1.0, guard = 1.0, law = 1.0;
};

/// A mass before a wall at side y = 0 with friction of level 1, pushed away from it with `push`.
std::string mass(const std::string& push, double y, double until, const Dress& dress) {
  return fmt::format(R"toml(
[parameters]
side = {:g}
[states]
y = {:.17g}
v = 0
[dynamics]
y = "v"
v = "side*({}) - ({:g})*sign({:g}*v)"
[[jumps]]
name = "hit"
when = "{:g}*y"
direction = "down"
set = {{ v = "-v/2" }}
[simulate]
until = {:.17g}
)toml",
                     dress.side, dress.side * y, push, std::copysign(1.0, dress.law), dress.law,
                     dress.side * dress.guard, until);
}

constexpr Dress dresses[] = {{}, {-1.0}, {1.0, 1e8, 1e-8}, {-1.0, 1e-8, 1e8}, {1.0, 1.0, -1.0}};

/// Where the law lets go. NOTE: the mass leaves like the third power of time, which a step of radau5 bends by its
/// tolerance: it may touch the wall again within 1e-7.
std::vector<Event> departures(const Result& result, const Accuracy& accuracy) {
  std::vector<Event> found;
  for (const auto& event : result.events) {
    if (event.kind == EventKind::leave_sliding) found.push_back(event);
  }
  EXPECT_FALSE(found.empty());
  if (accuracy.integrator != pipeline::Integrator::radau5) {
    EXPECT_EQ(result.events.back().t, found.back().t);
  }
  return found;
}

/// Whether the law has a selection at the first row at or behind t: none while the wall holds what it holds.
bool is_determined(const Result& result, double t) {
  const auto& rows = result.trajectory;
  std::size_t k = 0;
  while (rows.t[k] < t) ++k;
  EXPECT_EQ(rows.mode[k][0], 0) << "t = " << rows.t[k];
  return std::isfinite(rows.alpha[k][0]);
}

// Falls from 1 with 9 and rises with 11, so that impacts halve the speed and the way back takes sqrt(9/11) of it. The
// push reaches -1 at t = 4.8, where the wall may let friction hold the mass, and 1 at t = 5.2, where it leaves:
// v' = 5 (t - 5.2).
TEST(FrictionAtAWall, AMassThatBouncesComesToRestAndLeaves) {
  const double speed = std::sqrt(18.0) / 2, ratio = std::sqrt(9.0 / 11.0) / 2;
  const double limit = std::sqrt(2.0 / 9.0) + speed * (1.0 / 11.0 + 1.0 / std::sqrt(99.0)) / (1 - ratio);
  for (const auto& accuracy : {standard, fine, implicit}) {
    for (const Dress& dress : dresses) {
      const Result result = simulated(mass("-10 + 5*max(t - 3, 0)", 1, 6.2, dress), accuracy);
      ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
      ASSERT_EQ(limits_of(result).size(), 1U);
      EXPECT_NEAR(limits_of(result)[0].t, limit, 1e-8);
      const auto rest = limits_of(result)[0].x_after;
      for (const double entry : rest) EXPECT_NEAR(entry, 0, 1e-15);
      EXPECT_FALSE(is_determined(result, 2.0));
      expect_times(departures(result, accuracy), {5.2}, 1e-10);
      EXPECT_NEAR(result.final.x[0], dress.side * 5.0 / 6.0, 1e-8);
      EXPECT_NEAR(result.final.x[1], dress.side * 2.5, 1e-8);
    }
  }
}

// At rest at the wall from the start. Pulled away first, it leaves where 2 sin t = 1; pushed into the wall first, where
// -2 sin t = 1. Both go on with v = 2 (cos t1 - cos t) - (t - t1), and stop where that is zero.
TEST(FrictionAtAWall, AMassLeavesWhereTheDriveExceedsFriction) {
  for (const auto& accuracy : {standard, fine, implicit}) {
    for (const Dress& dress : dresses) {
      for (const double way : {1.0, -1.0}) {
        const double leaves = std::numbers::pi / 6 + (way > 0 ? 0.0 : std::numbers::pi);
        const double end = leaves + 1.5;
        const Result result = simulated(mass(way > 0 ? "2*sin(t)" : "-2*sin(t)", 0, end, dress), accuracy);
        ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
        expect_times(departures(result, accuracy), {leaves}, 1e-10);
        const double phase = std::numbers::pi / 6;
        const double speed = 2 * (std::cos(phase) - std::cos(phase + 1.5)) - 1.5;
        const double way_gone = 2 * (1.5 * std::cos(phase) - std::sin(phase + 1.5) + std::sin(phase)) - 1.5 * 1.5 / 2;
        EXPECT_NEAR(result.final.x[0], dress.side * way_gone, 1e-8);
        EXPECT_NEAR(result.final.x[1], dress.side * speed, 1e-8);
      }
    }
  }
}

// A belt under a mass that is pressed to a wall by 2 stops at t = 1 and runs again from t = 2 on, away from the wall.
// Friction of level 1 pulls it along with the belt, but not away from the wall; when the push ends, at t = 3, it does:
// v' = 1 until v = t - 2 is reached, which is never.
TEST(FrictionAtAWall, ABeltStopsAndStarts) {
  for (const auto& accuracy : {standard, fine}) {
    const Result result = simulated(R"toml(
[states]
y = 0
v = 0
[dynamics]
y = "v"
v = "if(t < 3, -2, 0) - sign(v - belt(t))"
[tables.belt]
x = [0, 1, 2, 5]
y = [1, 0, 0, 3]
[[jumps]]
name = "hit"
when = "y"
direction = "down"
set = { v = "-v/2" }
[simulate]
until = 4
)toml",
                                    accuracy);
    ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
    const auto& rows = result.trajectory;
    for (std::size_t k = 0; k < rows.t.size(); ++k) {
      if (rows.t[k] < 3 && rows.t[k] != 1 && rows.t[k] != 2) {
        EXPECT_EQ(rows.mode[k][0], rows.t[k] > 1 && rows.t[k] < 2 ? 0 : -1) << "t = " << rows.t[k];
      }
    }
    EXPECT_NEAR(result.final.x[0], 0.5, 1e-8);
    EXPECT_NEAR(result.final.x[1], 1, 1e-8);
  }
}

// Two masses, each pressed to its wall, rub on each other: what friction takes from one wall it puts on the other, and
// where they leave is a question of both.
TEST(FrictionAtAWall, FrictionBetweenMassesAtTwoWallsIsOutsideTheClass) {
  const Result result = simulated(R"toml(
[states]
y1 = 0
y2 = 0
v1 = 0
v2 = 0
[dynamics]
y1 = "v1"
y2 = "v2"
v1 = "-2 + t - sign(v1 - v2)"
v2 = "-2 + t + sign(v1 - v2)"
[[jumps]]
name = "hit1"
when = "y1"
direction = "down"
set = { v1 = "-v1/2" }
[[jumps]]
name = "hit2"
when = "y2"
direction = "down"
set = { v2 = "-v2/2" }
[simulate]
until = 4
)toml");
  EXPECT_EQ(result.status.termination, Termination::outside_class);
  EXPECT_NE(result.status.message.find("acts on several guards"), std::string::npos) << result.status.message;
}

}  // namespace
}  // namespace saltus::problems
