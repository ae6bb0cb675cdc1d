// Groups of modes by indicator beside jumps, their accumulation, kinks and switching functions, and as a start.
#include <array>
#include <cmath>
#include <numbers>
#include <string>
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

/// |x| -> 0 at unit speed, then held there by two regions.
SX held_at_zero(Builder& b, double initial) {
  const SX x = b.state("x", {initial});
  b.region(x, {{"x", SX(1.0)}}, "left");
  b.region(-x, {{"x", SX(-1.0)}}, "right");
  return x;
}

TEST(RegionsBeside, AJumpLeavesThemAndTheyAreReadAnew) {
  Builder b("pushed");
  const SX x = held_at_zero(b, 1.0);
  b.jump_at({2.0, 2.5}, {{"x", x - 0.75}});
  const auto run = run_tightly(b, 4.0);
  ASSERT_EQ(run.status.termination, Termination::completed) << run.status.message;
  ASSERT_EQ(run.events.size(), 4U);
  const std::array<double, 4> times{1.0, 2.0, 2.5, 3.5};  // at 2.5 the state is -0.25, then -1
  const std::array<Regions, 4> after{Regions{{"left", "right"}}, {{"left"}}, {{"left"}}, {{"left", "right"}}};
  for (std::size_t i = 0; i < times.size(); ++i) {
    EXPECT_NEAR(run.events[i].t, times[i], 1e-12) << i;
    EXPECT_EQ(*run.events[i].regions_after, after[i]) << i;
  }
  EXPECT_EQ(run.events[1].kind, EventKind::jump);
  EXPECT_EQ(*run.events[1].regions_before, (Regions{{"left", "right"}}));
  EXPECT_EQ(run.final.theta, (std::vector<double>{0.5, 0.5}));
}

TEST(RegionsBeside, AJumpOntoTheirBorderIsDecidedThere) {
  Builder b("put");
  const SX x = held_at_zero(b, 3.0);
  b.jump_at({1.0}, {{"x", 0.0 * x}});
  const auto run = run_tightly(b, 2.0);
  ASSERT_EQ(run.status.termination, Termination::completed) << run.status.message;
  ASSERT_EQ(run.events.size(), 1U);
  EXPECT_EQ(*run.events[0].regions_after, (Regions{{"left", "right"}}));
  EXPECT_EQ(run.final.x[0], 0.0);
}

TEST(RegionsBeside, AnAccumulationOfJumpsPassesWhileTheyHold) {
  // A ball with restitution 1/2 from height 5 under g = 10 rests at t = 1 + 2 (1/2 + 1/4 + ...) = 3.
  Builder b("ball");
  const SX x = held_at_zero(b, 2.0);
  const SX y = b.state("y", {5.0});
  const SX v = b.state("v", {0.0});
  b.dynamics("y", v);
  b.dynamics("v", -10);
  b.jump(y, model::Direction::down, {{"v", -0.5 * v}});
  const auto run = run_tightly(b, 4.0);
  ASSERT_EQ(run.status.termination, Termination::completed) << run.status.message;
  bool accumulated = false;
  for (const auto& event : run.events) {
    if (event.kind == EventKind::enter_sliding) {
      EXPECT_NEAR(event.t, 2.0, 1e-11);
    }
    if (event.kind != EventKind::accumulation) continue;
    accumulated = true;
    EXPECT_NEAR(event.t, 3.0, 1e-9);
    EXPECT_EQ(*event.regions_before, (Regions{{"left", "right"}}));
    EXPECT_EQ(*event.regions_after, (Regions{{"left", "right"}}));
  }
  EXPECT_TRUE(accumulated);
  EXPECT_EQ(run.final.x[0], 0.0);
}

TEST(RegionsBeside, ASwitchingFunctionInTheirFieldsMovesTheirWeights) {
  // The border of two regions holds x; a step in time of their fields, at y = 1, moves theta from 1/2 to 1/3.
  Builder b("step");
  const SX x = b.state("x", {0.0});
  const SX y = b.state("y", {0.0});
  b.dynamics("y", 1);
  const SX step = b.step(y - 1.0, "late");
  b.region(x, {{"x", SX(1.0)}}, "left");
  b.region(-x, {{"x", -1.0 + 0.5 * step}}, "right");
  const auto run = run_tightly(b, 2.0);
  ASSERT_EQ(run.status.termination, Termination::completed) << run.status.message;
  ASSERT_EQ(run.events.size(), 2U);  // start, late
  EXPECT_EQ(run.events[1].surfaces, (std::vector<std::string>{"late"}));
  EXPECT_EQ(run.events[1].kind, EventKind::crossing);
  ASSERT_EQ(run.final.theta.size(), 2U);
  EXPECT_NEAR(run.final.theta[0], 1.0 / 3.0, 1e-14);
  EXPECT_NEAR(run.final.theta[1], 2.0 / 3.0, 1e-14);
}

/// Three regions of 120 degrees whose fields point away from the origin, where the run starts.
void repelling_sectors(Builder& b) {
  const SX x = b.state("x", {0.0});
  const SX y = b.state("y", {0.0});
  const std::array<const char*, 3> names{"a", "b", "c"};
  for (std::size_t i = 0; i < 3; ++i) {
    const double angle = 2.0 * std::numbers::pi / 3.0 * static_cast<double>(i);
    const double c = std::cos(angle), s = std::sin(angle);
    b.region(-(c * x + s * y), {{"x", SX(c)}, {"y", SX(s)}}, names.at(i));
  }
}

TEST(RegionsBeside, AStartWhereAllRepelHasEveryAlternativeAndFollowsTheOneThatIsForced) {
  Builder free("repelling");
  repelling_sectors(free);
  const auto run = run_tightly(free, 1.0);
  ASSERT_EQ(run.status.termination, Termination::completed) << run.status.message;
  ASSERT_EQ(run.events.size(), 1U);
  EXPECT_EQ(run.events[0].kind, EventKind::start);
  EXPECT_EQ(run.events[0].unique, false);
  // Each alone, two by two along their border, and all three at rest.
  EXPECT_EQ(run.events[0].alternatives.size(), 6U);
  EXPECT_NEAR(std::hypot(run.final.x[0], run.final.x[1]), 1.0, 1e-12);

  Builder forced("repelling");
  repelling_sectors(forced);
  const auto along = run_tightly(forced, 1.0, {{1, 0}, {2, 0}, {0, -1}});
  ASSERT_EQ(along.status.termination, Termination::completed) << along.status.message;
  EXPECT_EQ(along.final.regions, (Regions{{"b", "c"}}));
  EXPECT_NEAR(along.final.x[0], -0.5, 1e-12);
  EXPECT_NEAR(along.final.x[1], 0.0, 1e-12);
  EXPECT_EQ(along.events[0].alternatives.size(), 6U);
  EXPECT_EQ(along.events[0].unique, false);

  const auto alone = run_tightly(forced, 1.0, {{2, 1}});
  ASSERT_EQ(alone.status.termination, Termination::completed) << alone.status.message;
  EXPECT_EQ(alone.final.regions, (Regions{{"c"}}));
  EXPECT_NEAR(alone.final.x[1], -std::sqrt(0.75), 1e-12);
}

TEST(RegionsBeside, ASpiralEndsWhereThreeMeet) {
  // Sectors of 120 degrees with the constant field (-1, 8) in the frame of their axis. From one border, at the distance
  // d, (d/2 - t, -d sin 60 + 8 t) is at the next one after t = d sqrt(3) / (8 + sqrt(3)), at the distance q d,
  // q = 1 - 2 t / d: the limit of the cycles is t / (1 - q) = d / 2.
  Builder b("spiral");
  const SX x = b.state("x", {0.5});
  const SX y = b.state("y", {-std::sqrt(0.75)});
  for (std::size_t i = 0; i < 3; ++i) {
    const double angle = 2.0 * std::numbers::pi / 3.0 * static_cast<double>(i);
    const double c = std::cos(angle), s = std::sin(angle);
    b.region(-(c * x + s * y), {{"x", SX(-c - 8.0 * s)}, {"y", SX(-s + 8.0 * c)}});
  }
  const auto run = run_tightly(b, 2.0);
  ASSERT_EQ(run.status.termination, Termination::completed) << run.status.message;
  const auto& limit = run.events.back();
  EXPECT_EQ(limit.kind, EventKind::accumulation);
  EXPECT_NEAR(limit.t, 0.5, 1e-11);
  EXPECT_EQ(limit.surfaces.size(), 2U);
  EXPECT_EQ(*limit.regions_after, (Regions{{"mode1", "mode2", "mode3"}}));
  EXPECT_NEAR(std::hypot(run.final.x[0], run.final.x[1]), 0.0, 1e-11);
  for (const double weight : run.final.theta) EXPECT_NEAR(weight, 1.0 / 3.0, 1e-12);
}

TEST(RegionsBeside, AForcedRegionThatIsNotThereIsTold) {
  Builder b("away");
  held_at_zero(b, 1.0);
  const auto run = run_tightly(b, 2.0, {{0, 1}});
  EXPECT_EQ(run.status.termination, Termination::no_admissible_mode);
  EXPECT_NE(run.status.message.find("initial_mode"), std::string::npos);
}

}  // namespace
}  // namespace saltus::event_integrator
