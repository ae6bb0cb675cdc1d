// Switching functions that hold signs of others: where several of those are slid on, and where cycles lead about them.
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "run_model.hpp"

namespace saltus::event_integrator {
namespace {

using casadi::SX;
using model::Builder;
using result::Termination;

TEST(Nested, BesideSeveralSlidingSurfacesAFunctionIsWatchedInEachOfTheirRegions) {
  // Slides on x = 0 and y = 0 from the start; z + sign(x)/2 is negative in all regions up to z = -1/2, at t = 1.5, and
  // has both signs behind that: a mode that holds one of them is none. At the selection, z + 0, it vanishes at t = 2.
  Builder b("two signs");
  const SX x = b.state("x", {0});
  const SX y = b.state("y", {0});
  const SX z = b.state("z", {-2});
  const SX side = b.sign(x);
  b.dynamics("x", -side + 0.25 * b.sign(y));
  b.dynamics("y", -b.sign(y) - 0.25 * side + 0.25 * b.sign(z + 0.5 * side));
  b.dynamics("z", 1);
  const auto result = testing::run_tightly(b, 4);
  EXPECT_EQ(result.status.termination, Termination::outside_class) << result.status.message;
  EXPECT_NEAR(result.status.time_reached, 1.5, 1e-12);
  EXPECT_EQ(result.events.size(), 1U);  // the start
}

TEST(Nested, BesideSeveralSlidingSurfacesAFunctionWithoutAJumpIsCrossed) {
  // max(x, 0) is 0 on both sides of x = 0: z + max(x, 0) is reached in all regions together, at t = 2.
  Builder b("no jump");
  const SX x = b.state("x", {0});
  const SX y = b.state("y", {0});
  const SX z = b.state("z", {-2});
  b.dynamics("x", -b.sign(x) + 0.25 * b.sign(y));
  b.dynamics("y", -b.sign(y) + 0.25 * b.sign(z + b.max(x, 0)));
  b.dynamics("z", 1);
  const auto result = testing::run_tightly(b, 4);
  ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
  ASSERT_EQ(result.events.size(), 2U);
  EXPECT_NEAR(result.events[1].t, 2.0, 1e-12);
}

TEST(Nested, AFunctionThatJumpsInEveryCycleIsNotHeldAtItsLimit) {
  // (x, y) spirals into the origin, to a quarter from cycle to cycle: x' = -sign(y)(1 + s/3), y' = sign(x)(1 - s/3),
  // with s = sign(x) sign(y). w = z + sign(y) has the sign of y, and jumps with it; z, which is 0.2 - 0.1 t, does not
  // depend on it.
  Builder b("cycles");
  const SX x = b.state("x", {0});
  const SX y = b.state("y", {1});
  const SX z = b.state("z", {0.2});
  const SX u = b.state("u", {0});
  const SX sign_x = b.sign(x), sign_y = b.sign(y);
  b.dynamics("x", -sign_y - sign_x / 3);
  b.dynamics("y", sign_x - sign_y / 3);
  b.dynamics("z", -0.1);
  b.dynamics("u", b.sign(z + sign_y));
  const auto result = testing::run_tightly(b, 10);
  ASSERT_FALSE(result.trajectory.t.empty());
  for (std::size_t row = 0; row < result.trajectory.t.size(); ++row) {
    EXPECT_NEAR(result.trajectory.x[row][2], 0.2 - 0.1 * result.trajectory.t[row], 1e-9) << row;
  }
}

TEST(Nested, WhatOnlyAFunctionThatJumpsAwayHasHeldIsLeftWithIt) {
  // Slides on x + sign(y)/2 = 1/2 and on z = 0, with det G = 1: z' = sign(x + sign(y)/2 - 1/2) - 1/2 depends on the
  // first selection only. y = 1 - t changes its sign at t = 1, behind which x - 1 is -1, and z' = -3/2.
  Builder b("held by another");
  const SX x = b.state("x", {0});
  const SX y = b.state("y", {1});
  const SX z = b.state("z", {0});
  const SX jumping = b.sign(x + 0.5 * b.sign(y) - 0.5);
  const SX held = b.sign(z);
  b.dynamics("x", -jumping + 0.5 - held);
  b.dynamics("y", -1);
  b.dynamics("z", jumping - 0.5);
  const auto result = testing::run_tightly(b, 1.5);
  ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
  EXPECT_EQ(result.events.front().t, 0.0);
  EXPECT_NEAR(result.events[1].t, 1.0, 1e-12);
  EXPECT_LT(result.final.x[2], -0.5);
}

TEST(Nested, WhatIsTooSlowForAFunctionThatJumpsAwayIsLeftWithIt) {
  // Two rate limiters in a row follow a step at 1.5, the first with rate 2, the second behind it with rate 1.
  for (const auto method : testing::every_method) {
    Builder b("limiters");
    const SX t = b.time(), first = b.state("first", {0.5}), second = b.state("second", {0.5});
    const SX reference = b.if_(model::greater(t, 1.5), 1, 0.5);
    b.dynamics("first", b.if_(model::greater(reference, first), 2, -1));
    b.dynamics("second", b.sign(first - second));
    IntegrationOptions options;
    options.method = method;
    options.until = 1.9;
    const auto result = testing::run_model(b, options);
    EXPECT_EQ(result.status.termination, Termination::completed) << result.status.message;
    EXPECT_NEAR(result.final.x[0], 1.0, 1e-14);
    EXPECT_NEAR(result.final.x[1], 0.9, 1e-14);
  }
}

TEST(Nested, AnInputThatStepsIsInsideWhatComparesIt) {
  // The surface at the step of the input is inside u > 0.5, and this one inside what is slid on.
  Builder b("input");
  const SX t = b.time(), y = b.state("y", {0.0}), u = b.control("u", {0.0});
  b.dynamics("y", b.sign(b.if_(model::greater(u, 0.5), 2, 0) - y));
  b.input("u", b.if_(model::greater(t, 1), 1, 0));
  const auto result = testing::run_tightly(b, 1.4);
  EXPECT_EQ(result.status.termination, Termination::completed) << result.status.message;
  EXPECT_NEAR(result.final.x[0], 0.4, 1e-14);
}

TEST(Nested, WhereSurfacesAndAKinkInsideAKinkMeetTheHiddenDynamicsLeavesAll) {
  // A start on y = 1/2, on x + y = 0 and at a kink of | |y - 1/2 - t/2| - 1|: y' = -1.25 - 1.6 sign(-x - y) or so. The
  // hidden dynamics leaves all three, the last one from a rounding beyond the end of its strip.
  Builder b("start at a kink");
  const SX x = b.state("x", {-0.5});
  const SX y = b.state("y", {0.5});
  b.dynamics("x", -0.75 - 1.1429043106330647 * x - 1.0277495677542057 * b.sign(y - 0.5));
  b.dynamics("y", 0.5 + 0.5 * x - 0.751488787818674 * y - 1.5940262861003238 * b.sign(-x - y) - 0.22182261105549905 -
                      0.9023489012688066 * b.abs(b.abs(-0.5 + y - 0.5 * b.time()) - 1));
  const auto result = testing::run_tightly(b, 1);
  ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
  ASSERT_EQ(result.events.size(), 1U);
  EXPECT_LT(result.final.x[1], 0.5);
  EXPECT_GT(-result.final.x[0] - result.final.x[1], 0.0);
}

TEST(Nested, AKinkThatIsZeroAllAlongASurfaceFollowsIt) {
  // A controller that stops integrating where it saturates slides on u = L, where its saturation has a kink. Written as
  // a condition the saturation has no kink of its own.
  const auto run = [](ode::Method method, bool as_kink) {
    Builder b("anti-windup");
    const SX integral = b.state("I", {0}), x = b.state("x", {0.2}), v = b.state("v", {-0.9});
    const double limit = 1.2;
    const SX error = 1.125 * SX::sin(1.7 * b.time()) - x, u = 0.3 * error + integral;
    const auto above = model::greater(u, limit), below = model::greater(-limit, u);
    const SX output = as_kink ? b.min(b.max(u, -limit), limit) : b.if_(above, limit, b.if_(below, -limit, u));
    b.dynamics("I", b.if_(above, b.if_(model::greater(error, 0), 0, error),
                          b.if_(below, b.if_(model::greater(0, error), 0, error), error)));
    b.dynamics("x", v);
    b.dynamics("v", 1.25 * output - 2 * v - 0.6 * x);
    IntegrationOptions options;
    options.method = method;
    options.until = 20;
    return testing::run_model(b, options);
  };
  for (const auto method : testing::every_method) {
    const auto found = run(method, true), expected = run(method, false);
    ASSERT_EQ(found.status.termination, Termination::completed) << found.status.message;
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(found.final.x[i], expected.final.x[i], 1e-7);
    EXPECT_EQ(found.events.size(), expected.events.size());
    for (const auto& event : found.events) EXPECT_EQ(event.unique, true) << event.t;
  }
}

TEST(Nested, CyclesEndAtRestWhereAKinkInsideTheControlHasBothSigns) {
  // A relay behind a dead zone, and dry friction: the control jumps from one end of the dead zone to the other with the
  // relay. At the limit of the switches it is any number between: the state rests.
  for (const auto method : testing::every_method) {
    Builder b("dead zone");
    const SX x = b.state("x", {1}), v = b.state("v", {0});
    const SX u = -x - 0.6 * b.sign(x) - 0.3 * v, used = u - b.max(b.min(u, 0.15), -0.15);
    b.dynamics("x", v);
    b.dynamics("v", 3 * used - 0.8 * v - 0.4 * b.sign(v));
    IntegrationOptions options;
    options.method = method;
    options.until = 10;
    const auto result = testing::run_model(b, options);
    ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
    EXPECT_EQ(result.events.back().kind, result::EventKind::accumulation);
    EXPECT_NEAR(result.final.x[0], 0.0, 1e-9);
    EXPECT_NEAR(result.final.x[1], 0.0, 1e-9);
  }
}

}  // namespace
}  // namespace saltus::event_integrator
