// Groups of modes by indicator: two regions are a step, three meet at a point, and numbering does not matter.
#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "run_model.hpp"

namespace saltus::event_integrator {
namespace {

using casadi::SX;
using model::Builder;
using result::EventKind;
using result::Regions;
using result::Termination;
using testing::run_tightly;

TEST(Regions, TwoOfOneIndicatorAreOutsideTheClass) {
  // Behind x = 0 nothing says which of two fields holds.
  Builder b("twins");
  const SX x = b.state("x", {-1.0});
  b.state("y", {0.0});
  b.region(x, {{"x", SX(1.0)}, {"y", SX(0.0)}}, "before");
  b.region(-x, {{"x", SX(1.0)}, {"y", SX(1.0)}}, "up");
  b.region(-x, {{"x", SX(1.0)}, {"y", SX(-1.0)}}, "down");
  const auto run = run_tightly(b, 2.0);
  EXPECT_EQ(run.status.termination, Termination::outside_class);
  EXPECT_NE(run.status.message.find("'up' and 'down' have the same indicator"), std::string::npos)
      << run.status.message;
}

TEST(Regions, TwoAreTheSameModelAsAStep) {
  const auto state = [](Builder& b) {
    const SX x = b.state("x", {1.0});
    const SX y = b.state("y", {0.0});
    b.dynamics("y", 1);
    return std::pair{x, y};
  };
  Builder by_indicator("regions");
  {
    const auto [x, y] = state(by_indicator);
    by_indicator.region(x, {{"x", 1.0 + 0.3 * cos(3 * y)}}, "left");
    by_indicator.region(-x, {{"x", -1.0 + 1.5 * sin(2 * y)}}, "right");
  }
  Builder by_condition("conditions");
  {
    const auto [x, y] = state(by_condition);
    by_condition.mode(model::less(x, 0.0), {{"x", 1.0 + 0.3 * cos(3 * y)}});
    by_condition.otherwise({{"x", -1.0 + 1.5 * sin(2 * y)}});
  }
  const auto regions = run_tightly(by_indicator, 12);
  const auto steps = run_tightly(by_condition, 12);
  ASSERT_EQ(regions.status.termination, Termination::completed) << regions.status.message;
  ASSERT_EQ(regions.events.size(), steps.events.size());
  ASSERT_GE(steps.events.size(), 5U);
  for (std::size_t i = 0; i < steps.events.size(); ++i) {
    EXPECT_EQ(regions.events[i].t, steps.events[i].t);
    EXPECT_EQ(regions.events[i].kind, steps.events[i].kind);
  }
  EXPECT_EQ(regions.final.x, steps.final.x);
  EXPECT_EQ(*regions.events[0].regions_before, (Regions{{"right"}}));
  EXPECT_EQ(*regions.events[0].regions_after, (Regions{{"left", "right"}}));
  EXPECT_EQ(regions.events[0].surfaces, (std::vector<std::string>{"left"}));
  EXPECT_EQ(regions.trajectory.regions.size(), regions.trajectory.t.size());
}

/// Sectors of 120 degrees whose fields point to the origin; a wind that sets in at t = 2 blows along -x.
Integration sectors(const std::array<int, 3>& order) {
  Builder b("sectors");
  const SX x = b.state("x", {1.0});
  const SX y = b.state("y", {0.3});
  b.dynamics("x", -b.max(b.time() - 2.0, 0.0) / 8.0);
  const std::array<const char*, 3> names{"east", "north", "south"};
  for (const int i : order) {
    const double angle = 2.0 * std::numbers::pi / 3.0 * i;
    const double c = std::cos(angle), s = std::sin(angle);
    b.region(-(c * x + s * y), {{"x", SX(-c)}, {"y", SX(-s)}}, names.at(static_cast<std::size_t>(i)));
  }
  return run_tightly(b, 8.0);
}

TEST(Regions, ThreeMeetAtAPointAndHoldTheSolutionThere) {
  // Into the border of east and north, along it at speed 1/2 into the origin, held there with weights (1 + 2b)/3,
  // (1 - b)/3, (1 - b)/3 in the wind b; at b = -1/2 out along the border of north and south.
  const auto result = sectors({0, 1, 2});
  ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
  ASSERT_EQ(result.events.size(), 3U);
  const double border = 1.0 - 0.3 / std::sqrt(3.0);
  const std::array<double, 3> times{border, border + 1.2 / std::sqrt(3.0), 6.0};
  const std::array<EventKind, 3> kinds{EventKind::enter_sliding, EventKind::enter_sliding, EventKind::leave_sliding};
  const std::array<Regions, 3> after{Regions{{"east", "north"}}, Regions{{"east", "north", "south"}},
                                     Regions{{"north", "south"}}};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(result.events[i].t, times[i], 1e-10) << i;
    EXPECT_EQ(result.events[i].kind, kinds[i]) << i;
    EXPECT_EQ(*result.events[i].regions_after, after[i]) << i;
    EXPECT_EQ(result.events[i].unique, true) << i;
  }
  EXPECT_EQ(result.events[2].surfaces, (std::vector<std::string>{"east"}));
  EXPECT_NEAR(result.final.x[0], -0.25, 1e-10);
  EXPECT_NEAR(result.final.x[1], 0.0, 1e-12);
  EXPECT_EQ(result.final.regions, (Regions{{"north", "south"}}));
}

TEST(Regions, TheirOrderDoesNotMatter) {
  const auto reference = sectors({0, 1, 2});
  for (const auto& order : {std::array{0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}}) {
    const auto result = sectors(order);
    ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
    ASSERT_EQ(result.events.size(), reference.events.size());
    for (std::size_t i = 0; i < result.events.size(); ++i) {
      EXPECT_NEAR(result.events[i].t, reference.events[i].t, 1e-11);
      EXPECT_EQ(result.events[i].kind, reference.events[i].kind);
    }
    EXPECT_NEAR(result.final.x[0], reference.final.x[0], 1e-11);
  }
}

TEST(Regions, HysteresisByFourRegionsHasItsPeriod) {
  // A thermostat (on below 18, off above 20) as a Filippov system in frozen time: psi = (y - 18)/2 and w in the plane,
  // w = 0 while on, w = 1 while off; the clock stands still in between. Physical times in closed form.
  Builder b("hysteresis");
  const SX y = b.state("y", {15.0});
  const SX w = b.state("w", {0.0});
  b.state("clock", {0.0});
  const SX psi = (y - 18.0) / 2.0;
  const double a = 5.0;
  const SX down = -a * pow(psi - 1, 2) / (1 + pow(psi - 1, 2));
  const SX up = a * pow(psi, 2) / (1 + pow(psi, 2));
  const auto indicator = [&](double z1, double z2) { return pow(psi - z1, 2) + pow(w - z2, 2); };
  b.region(indicator(0.25, -0.25), {{"y", 2 * (10.0 - 0.2 * y)}, {"w", -down}, {"clock", 2.0}}, "on");
  b.region(indicator(0.25, 0.25), {{"w", down}}, "to_on");
  b.region(indicator(0.75, 0.75), {{"w", up}}, "to_off");
  b.region(indicator(0.75, 1.25), {{"y", -0.4 * y}, {"w", -up}, {"clock", 2.0}}, "off");
  const auto result = run_tightly(b, 4.0);
  ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
  std::vector<double> clock;  // at which the sliding modes are left
  for (const auto& event : result.events) {
    if (event.regions_before && event.regions_before->front().size() == 2) clock.push_back(event.x[2]);
  }
  ASSERT_GE(clock.size(), 4U);
  const double off = 5.0 * std::log(35.0 / 30.0), cool = 5.0 * std::log(20.0 / 18.0),
               heat = 5.0 * std::log(32.0 / 30.0);
  EXPECT_NEAR(clock[0], off, 1e-9);
  EXPECT_NEAR(clock[1], off + cool, 1e-9);
  EXPECT_NEAR(clock[2], off + cool + heat, 1e-9);
}

TEST(Regions, TwoGroupsAndAStepBesideThem) {
  // Each of the three holds its own state at 0 from |x_i| on; none depends on the others.
  Builder b("groups");
  const SX x = b.state("x", {0.5}), y = b.state("y", {0.75}), z = b.state("z", {1.0});
  b.region(x, {{"x", SX(1.0)}}, "", "first");
  b.region(-x, {{"x", SX(-1.0)}}, "", "first");
  b.region(y, {{"y", SX(1.0)}}, "low", "second");
  b.region(-y, {{"y", SX(-1.0)}}, "high", "second");
  b.dynamics("z", -b.sign(z));
  const auto result = run_tightly(b, 2.0);
  ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
  ASSERT_EQ(result.events.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(result.events[i].t, 0.5 + 0.25 * static_cast<double>(i), 1e-13);
  EXPECT_EQ(result.final.regions, (Regions{{"mode1", "mode2"}, {"low", "high"}}));
  EXPECT_EQ(result.final.mode, (result::Mode{0}));
}

}  // namespace
}  // namespace saltus::event_integrator
