// What the engine does with the richer parts of a model: nested terms, time events, inputs, [[events]], inclusions.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "run_model.hpp"
#include "saltus/event_integrator/integrate.hpp"
#include "saltus/model/builder.hpp"

namespace saltus::event_integrator {
namespace {

using casadi::SX;
using model::Builder;
using model::greater;
using model::less;
using model::less_equal;
using result::EventKind;
using result::Termination;

Integration run(Builder& builder, double until, const std::vector<std::pair<int, int>>& forced = {}) {
  return testing::run_model(builder, until, {1e-10, 1e-12}, forced);
}

TEST(Behaviour, SlidingGoesOnWithANewGradientAcrossAKinkInsidePsi) {
  // Sliding on v + max(x, 0) = 0: v' = 0 before x = 0, v' = -1 behind it, alpha 1/2 then 3/4.
  Builder b("nested");
  const SX x = b.state("x", {-1});
  const SX v = b.state("v", {-0.5});
  b.dynamics("x", 1);
  b.dynamics("v", -2 * b.sign(v + b.max(x, 0)));
  const auto result = run(b, 4);
  ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
  ASSERT_EQ(result.events.size(), 1U);
  EXPECT_NEAR(result.events[0].t, 0.25, 1e-14);
  EXPECT_NEAR(result.final.x[1], -3.0, 1e-12);
  EXPECT_NEAR(result.final.alpha[0], 0.75, 1e-12);
}

TEST(Behaviour, SlidingEndsAtAKinkInsidePsiWhereTheNewGradientNeedsTooMuch) {
  // Behind x = 0 sliding would need v' = -3, but |v'| <= 2.
  Builder b("nested");
  const SX x = b.state("x", {-1});
  const SX v = b.state("v", {-0.5});
  b.dynamics("x", 1);
  b.dynamics("v", -2 * b.sign(v + 3 * b.max(x, 0)));
  const auto result = run(b, 2);
  ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
  ASSERT_EQ(result.events.size(), 2U);
  EXPECT_EQ(result.events[1].kind, EventKind::leave_sliding);
  EXPECT_NEAR(result.events[1].t, 1.0, 1e-14);
  EXPECT_NEAR(result.final.x[1], -2.0, 1e-12);
}

TEST(Behaviour, NestedPsiThatJumpsIsReadAnew) {
  // psi = y + 2 sign(x) changes its sign when x does, without passing 0.
  Builder b("jumping psi");
  const SX x = b.state("x", {-1});
  const SX y = b.state("y", {1});
  b.dynamics("x", 1);
  b.dynamics("y", 0.25 * b.sign(y + 2 * b.sign(x)));
  const auto result = run(b, 2);
  ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
  ASSERT_EQ(result.events.size(), 1U);
  EXPECT_EQ(result.events[0].kind, EventKind::crossing);
  EXPECT_NEAR(result.events[0].t, 1.0, 1e-15);
  EXPECT_NEAR(result.final.x[1], 1.0, 1e-14);
}

TEST(Behaviour, TimeEventsRestartAndAreNotListed) {
  Builder b("clock");
  b.state("x", {0});
  b.dynamics("x", b.if_(less(b.time(), 1.0), 1.0, -2.0) + b.step(sin(b.time())));
  const auto result = run(b, 4);
  ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
  EXPECT_TRUE(result.events.empty());
  EXPECT_NEAR(result.final.x[0], 1.0 - 6.0 + std::acos(-1.0), 1e-13);
}

TEST(Behaviour, SteppedInputFlipsAStateSurfaceWithoutPassingZero) {
  Builder b("stepped input");
  const SX x = b.state("x", {1});
  const SX u = b.control("u", {0});
  b.input("u", b.if_(less(b.time(), 1.0), 0.0, 2.0));
  b.dynamics("x", -0.1 * b.sign(x - u));
  const auto result = run(b, 3);
  ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
  ASSERT_EQ(result.events.size(), 1U);
  EXPECT_EQ(result.events[0].kind, EventKind::crossing);
  EXPECT_EQ(result.events[0].t, 1.0);
  EXPECT_NEAR(result.final.x[0], 1.1, 1e-14);
  EXPECT_EQ(result.trajectory.u.back()[0], 2.0);
}

TEST(Behaviour, AizermanPyatnitskiiSlidesAtItsOwnRoot) {
  // -(1 + 3 a)(2 a - 1) + t / 10 = 0 has the root (1 + sqrt(25 + 24 t / 10)) / 12.
  Builder b("ap");
  b.set_inclusion(model::Inclusion::aizerman_pyatnitskii);
  const SX x = b.state("x", {-1});
  b.dynamics("x", -b.if_(greater(x, 0), 4.0, 1.0) * b.sign(x) + 0.1 * b.time());
  const auto result = run(b, 30);
  ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
  EXPECT_EQ(result.final.x[0], 0.0);
  EXPECT_NEAR(result.final.alpha[0], (1.0 + std::sqrt(97.0)) / 12.0, 1e-12);
}

TEST(Behaviour, FilippovInterpolatesTheSameModelLinearly) {
  Builder b("filippov");
  const SX x = b.state("x", {-1});
  b.dynamics("x", -b.if_(greater(x, 0), 4.0, 1.0) * b.sign(x) + 0.1 * b.time());
  const auto result = run(b, 30);
  EXPECT_NEAR(result.final.alpha[0], 0.8, 1e-12);
}

TEST(Behaviour, UserEventsHaveDirectionsAndMayStop) {
  Builder b("oscillator");
  const SX q = b.state("q", {1});
  const SX v = b.state("v", {0});
  b.dynamics("q", v);
  b.dynamics("v", -q);
  b.event(q, {"down", model::Direction::down});
  b.event(greater(q, 0.5) && greater(v, 0.0), {"both_hold", model::Direction::up});
  b.event(v - 0.9, {"fast", model::Direction::both, model::AtEvent::stop});
  const auto result = run(b, 10);
  const double pi = std::acos(-1.0);
  ASSERT_EQ(result.status.termination, Termination::stopped_by_event);
  ASSERT_EQ(result.events.size(), 2U);
  EXPECT_EQ(*result.events[0].name, "down");
  EXPECT_NEAR(result.events[0].t, pi / 2, 1e-9);
  EXPECT_EQ(*result.events[1].name, "fast");
  EXPECT_NEAR(result.final.t, pi + std::asin(0.9), 1e-9);
}

TEST(Behaviour, ConditionThatHoldsFromTheStartHasNoEdgeThere) {
  Builder b("fall");
  const SX x = b.state("x", {3});
  const SX v = b.state("v", {0});
  b.dynamics("x", v);
  b.dynamics("v", -1 + 0.0 * x);
  b.event(less(v, 0.0), {"moves_down"});
  b.event(less(x, 1.0), {"low", model::Direction::up});
  const auto result = run(b, 3);
  ASSERT_EQ(result.events.size(), 1U);
  EXPECT_EQ(*result.events[0].name, "low");
  EXPECT_NEAR(result.events[0].t, 2.0, 1e-12);
}

TEST(Behaviour, SurfaceThatStepsAwayIsLeftNotFollowed) {
  // Sliding on y = 0; at t = 0.7 the surface steps to y = 0.3: y rises at 3.5 and arrives after 0.3 / 3.5.
  Builder b("stepping surface");
  const SX y = b.state("y", {1});
  b.dynamics("y", -3 * b.sign(y - b.if_(less(b.time(), 0.7), 0.0, 0.3)) + 0.5);
  const auto result = run(b, 2);
  ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
  ASSERT_EQ(result.events.size(), 3U);
  EXPECT_EQ(result.events[1].t, 0.7);
  EXPECT_EQ(result.events[1].kind, EventKind::leave_sliding);
  EXPECT_EQ(result.events[1].x[0], 0.0);
  EXPECT_EQ(result.events[1].x_after[0], 0.0);
  EXPECT_NEAR(result.events[2].t, 0.7 + 0.3 / 3.5, 1e-14);
}

TEST(Behaviour, UserEventsThatVanishTogetherAreAllRecorded) {
  Builder b("together");
  const SX x = b.state("x", {1});
  const SX z = b.state("z", {1});
  b.dynamics("x", -1);
  b.dynamics("z", -1);
  b.event(z, {"u1", model::Direction::both, model::AtEvent::stop});
  b.event(x, {"u2"});
  b.event(less_equal(x, 0.0), {"u3"});
  const auto result = run(b, 3);
  EXPECT_EQ(result.status.termination, Termination::stopped_by_event);
  ASSERT_EQ(result.events.size(), 3U);
  for (const auto& event : result.events) EXPECT_NEAR(event.t, 1.0, 1e-15);
}

TEST(Behaviour, UserEventTogetherWithASwitchIsRecordedOnce) {
  Builder b("with a switch");
  const SX x = b.state("x", {1});
  b.dynamics("x", -2 - b.sign(x));
  b.event(x + 0.0 * b.time(), {"zero"});
  const auto result = run(b, 3);
  ASSERT_EQ(result.events.size(), 2U);
  EXPECT_NEAR(result.events[0].t, 1.0 / 3.0, 1e-15);
  EXPECT_EQ(result.events[0].t, result.events[1].t);
}

/// A user function with a double zero at the start, beside which its interpolant has roundings of both signs.
TEST(Behaviour, AMultipleZeroOfAUserFunctionAtTheStartIsNoEvent) {
  for (const double until : {3.0, 4.0, 5.0, 6.0, 7.0}) {
    Builder b("fall");
    const SX x = b.state("x", {0});
    const SX v = b.state("v", {0});
    b.dynamics("x", v);
    b.dynamics("v", -0.3);
    b.event(sin(10.0 * x));
    const auto result = run(b, until);
    ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
    const double turn = std::acos(-1.0) / 1.5;
    ASSERT_EQ(result.events.size(), static_cast<std::size_t>(until * until / turn)) << until;
    for (std::size_t k = 0; k < result.events.size(); ++k) {
      EXPECT_NEAR(result.events[k].t, std::sqrt(static_cast<double>(k + 1) * turn), 1e-12) << until;
    }
  }
}

/// x and v are 0 for good, where max(x, v) has a kink whose function is 0 to any order.
TEST(Behaviour, AKinkMayBeStoodOn) {
  Builder b("rest");
  const SX x = b.state("x", {0});
  const SX v = b.state("v", {0});
  b.dynamics("x", v);
  b.dynamics("v", -x - 0.2 * b.sign(v));
  b.event(b.max(x, v) - 0.6);
  const auto result = run(b, 3);
  ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
  ASSERT_EQ(result.events.size(), 1U);
  EXPECT_EQ(result.events[0].kind, EventKind::start);
  EXPECT_EQ(result.final.x, (std::vector<double>{0.0, 0.0}));
}

TEST(Behaviour, TimeFunctionsMayVanishAtTheStart) {
  Builder b("square wave");
  const SX x = b.state("x", {1});
  const double pi = std::acos(-1.0);
  b.dynamics("x", -x + b.sign(sin(2 * pi * b.time())));
  const auto result = run(b, 1);
  ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
  // One period of x' = -x +- 1 from 1: first x stays 1, then it falls towards -1.
  EXPECT_NEAR(result.final.x[0], -1.0 + 2.0 * std::exp(-0.5), 1e-9);
}

TEST(Behaviour, RootOfPsiOnBothSidesIsCrossed) {
  // x' = -1 - sqrt|x| sign x: finite and continuous at x = 0, undefined for each branch on the other side.
  Builder b("root");
  const SX x = b.state("x", {1});
  b.dynamics("x", -1 - sqrt(b.abs(x)) * b.sign(x) - 0.25 * b.sign(x));
  const auto result = run(b, 1);
  ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
  ASSERT_EQ(result.events.size(), 1U);
  EXPECT_EQ(result.events[0].kind, EventKind::crossing);
  // From 1 to 0: integral of dx / (1.25 + sqrt x) = 2 (1 - 1.25 ln(1 + 1 / 1.25)).
  EXPECT_NEAR(result.events[0].t, 2.0 * (1.0 - 1.25 * std::log(1.8)), 1e-9);
}

TEST(Behaviour, OutflowStandsStillAtTheEmptyTankAndFillsAgain) {
  // h' = -sqrt(max(h, 0)) / 2 + inflow from t = 6 on: empty at t = 4.
  Builder b("tank");
  const SX h = b.state("h", {1});
  b.dynamics("h", -0.5 * sqrt(b.max(h, 0)) + b.if_(greater(b.time(), 6.0), 0.1, 0.0));
  const auto result = run(b, 5);
  ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
  EXPECT_NEAR(result.final.x[0], 0.0, 1e-12);
}

TEST(Behaviour, ForcedModeOnARepellingSurfaceIsKept) {
  Builder b("repelling");
  const SX x = b.state("x", {0});
  b.dynamics("x", b.sign(x));
  const auto result = run(b, 1, {{0, 0}});
  ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
  EXPECT_EQ(result.final.x[0], 0.0);
  ASSERT_EQ(result.events.size(), 1U);
  EXPECT_EQ(result.events[0].unique, std::optional<bool>(false));
}

/// v leaves 0.2 upwards or stays; w + 1/2 - v slides if v allows it.
Builder two_choices() {
  Builder b("two choices");
  const SX v = b.state("v", {0.2});
  const SX w = b.state("w", {0.7});
  b.dynamics("v", b.sign(v - 0.2) + 0.1);
  b.dynamics("w", b.if_(greater(w, v + 0.5), -1, 1));
  return b;
}

TEST(Behaviour, AlternativesAreAdmissibleModesWithTheirSelections) {
  auto b = two_choices();
  const auto result = run(b, 1);
  ASSERT_EQ(result.events.size(), 1U);
  const auto& event = result.events[0];
  EXPECT_EQ(*event.mode_after, (result::Mode{1, -1}));
  ASSERT_EQ(event.alternatives.size(), 2U);
  for (const auto& other : event.alternatives) {
    EXPECT_EQ(other.mode[1], 0);
    EXPECT_NEAR(other.alpha[0], other.mode[0] == 0 ? 0.45 : 0.0, 1e-14);
    EXPECT_NEAR(other.alpha[1], other.mode[0] == 0 ? 0.5 : 0.95, 1e-14);
  }
}

TEST(Behaviour, AForcedModeHasTheRestDecidedForIt) {
  for (const int mode : {-1, 0}) {
    auto b = two_choices();
    const auto result = run(b, 1, {{0, mode}});
    ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
    EXPECT_EQ(*result.events[0].mode_after, (result::Mode{mode, 0}));
    EXPECT_EQ(result.events[0].unique, std::optional<bool>(false));
    EXPECT_NE(result.events[0].reason.find("initial_mode"), std::string::npos);
  }
}

TEST(Behaviour, CoupledSurfacesAreSlidOnTogether) {
  // Sliding on y = 0 from t = 2/3 (x = 2/3) with x' = -5/4, up to the origin.
  Builder b("coupled");
  const SX x = b.state("x", {1});
  const SX y = b.state("y", {1});
  b.dynamics("x", -b.sign(x) + 0.5 * b.sign(y));
  b.dynamics("y", -b.sign(y) - 0.5 * b.sign(x));
  const auto result = run(b, 5);
  ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
  ASSERT_EQ(result.events.size(), 2U);
  EXPECT_NEAR(result.events[1].t, 1.2, 1e-12);
  EXPECT_EQ(*result.events[1].mode_after, (result::Mode{0, 0}));
  EXPECT_EQ(result.events[1].unique, std::optional<bool>(true));
  EXPECT_NE(result.events[1].reason.find("sliding on the intersection"), std::string::npos) << result.events[1].reason;
  EXPECT_EQ(result.final.x, (std::vector<double>{0.0, 0.0}));
}

TEST(Behaviour, AReasonIsAboutListedSurfacesOnly) {
  // At t = 1 a state surface, a time event and a kink are at zero together.
  Builder b("together");
  const SX x = b.state("x", {-1});
  b.state("y", {0});
  b.dynamics("x", 1);
  b.dynamics("y", b.sign(x) + b.step(b.time() - 1) + b.abs(b.time() + x - 1));
  const auto result = run(b, 2);
  ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
  ASSERT_EQ(result.events.size(), 1U);
  EXPECT_EQ(result.events[0].reason, "x: both fields point to psi > 0");
}

TEST(Behaviour, AUserEventOnASlidingSurfaceHasTheSelectionsOfItsTime) {
  // Sliding on x = 0 with alpha = (1 + t/2)/2.
  Builder b("slides");
  const SX x = b.state("x", {0});
  b.dynamics("x", -b.sign(x) + 0.5 * b.time());
  b.event(b.time() - 1.0);
  const auto result = run(b, 1.5);
  ASSERT_EQ(result.events.size(), 2U);
  ASSERT_EQ(result.events[1].kind, EventKind::user);
  EXPECT_NEAR((*result.events[1].alpha_before)[0], 0.75, 1e-14);
  EXPECT_NEAR((*result.events[1].alpha_after)[0], 0.75, 1e-14);
}

TEST(Behaviour, SuperTwistingIsHeldAtItsLimit) {
  for (const double gain : {1.5, 2.5}) {
    Builder b("super-twisting");
    const SX x1 = b.state("x1", {1});
    const SX x2 = b.state("x2", {0});
    const SX sign = b.sign(x1);
    b.dynamics("x1", -gain * sqrt(b.abs(x1)) * sign + x2);
    b.dynamics("x2", -1.1 * sign);
    const auto result = run(b, 20);
    EXPECT_EQ(result.status.termination, Termination::completed) << gain << ": " << result.status.message;
    EXPECT_GT(result.events.size(), 5U);
    EXPECT_EQ(result.events.back().kind, EventKind::accumulation);
    EXPECT_EQ(result.final.x, (std::vector<double>{0.0, 0.0}));
    EXPECT_EQ(result.final.mode, (std::vector<int>{0}));
    EXPECT_NEAR(result.final.alpha[0], 0.5, 1e-12);
  }
}

/// h' = -2 sqrt|x| sign x - c, x = h - 1, from x = 1: with s = sqrt|x| the surface is crossed at t* = 1 - c/2 log(1 +
/// 2/c), where the slope of the field is infinite and x' = -c, and t - t* = -s - c/2 log(1 - 2 s/c) behind it. The last
/// step before may end at 0 itself, as h has no digits below 1e-16.
TEST(Behaviour, ARootIsCrossedWhereItsSlopeIsInfinite) {
  for (int k = 1; k <= 60; ++k) {
    const double c = 0.02 * k;
    const double crossing = 1.0 - 0.5 * c * std::log1p(2.0 / c);
    for (const auto method : {ode::Method::dopri5, ode::Method::dop853}) {
      Builder b("tank");
      const SX h = b.state("h", {2});
      b.dynamics("h", -2 * sqrt(b.abs(h - 1)) * b.sign(h - 1) - c);
      // Half of the way to the rest at s = c/2.
      const double until = crossing - 0.25 * c - 0.5 * c * std::log(0.5);
      IntegrationOptions options;
      options.method = method;
      options.tolerances = {1e-10, 1e-12};
      options.until = until;
      const auto result = testing::run_model(b, options);
      ASSERT_EQ(result.status.termination, Termination::completed) << c << ": " << result.status.message;
      EXPECT_NEAR(std::sqrt(1.0 - result.final.x[0]), 0.25 * c, 1e-8) << c;
    }
  }
}

/// x'' = -sign x - d x': a cycle from the speed v takes 4 v and leaves v (1 - 4/3 d v), so that cycles shrink like 1/k
/// and the speed like exp(-d t / 3). Cubic damping: k^-1/3.
TEST(Behaviour, CyclesThatShrinkLikeAPowerOfTheirNumberAreSaidToDoSo) {
  const auto message = [](const auto& damping) {
    Builder b("relay");
    const SX x = b.state("x", {1});
    const SX v = b.state("v", {0});
    b.switching("s", x);
    b.dynamics("x", v);
    b.dynamics("v", -b.sign(x) - damping(b, v));
    IntegrationOptions options;
    options.until = 1e4;
    options.max_events = 1000;
    options.tolerances = {1e-9, 1e-11};
    const auto result = testing::run_model(b, options);
    EXPECT_EQ(result.status.termination, Termination::iteration_limit) << result.status.message;
    EXPECT_EQ(result.events.size(), 1000U);
    return result.status.message;
  };
  const std::string damped = message([](Builder&, const SX& v) { return 0.7 * v; });
  EXPECT_NE(damped.find("cycles of 's' shrink like the power -1 of"), std::string::npos) << damped;
  EXPECT_NE(damped.find("as t -> infinity only"), std::string::npos) << damped;
  EXPECT_EQ(damped.find("raise"), std::string::npos) << damped;
  // A cycle leaves v - c v^4.
  const std::string slowly = message([](Builder&, const SX& v) { return v * v * v; });
  EXPECT_NE(slowly.find("shrink like the power -0.33 of"), std::string::npos) << slowly;
}

TEST(Behaviour, SwitchesThatDoNotShrinkAreNotSaidToDoSo) {
  Builder b("relay");
  const SX x = b.state("x", {0.01});
  const SX v = b.state("v", {0});
  b.switching("s", x);
  b.dynamics("x", v);
  b.dynamics("v", -b.sign(x));
  IntegrationOptions options;
  options.until = 1000.0;
  options.max_events = 1000;
  const auto result = testing::run_model(b, options);
  EXPECT_EQ(result.status.termination, Termination::iteration_limit);
  EXPECT_EQ(result.status.message.find("shrink"), std::string::npos) << result.status.message;
}

TEST(Behaviour, APowerAsSwitchingFunctionIsSaidToBeOne) {
  for (const int power : {2, 3}) {
    Builder b("power");
    const SX x = b.state("x", {1});
    // The field below moves on, the one above stays, or comes back.
    b.dynamics("x", b.if_(greater(pow(x - 1, power), 0), power == 2 ? 0 : -1, 1));
    const auto result = run(b, 3);
    EXPECT_EQ(result.status.termination, Termination::outside_class) << result.status.message;
    EXPECT_NE(result.status.message.find("gradient"), std::string::npos) << result.status.message;
  }
}

TEST(Behaviour, EveryEventHasTwoRowsAndTheEndIsARow) {
  Builder b("friction");
  const SX q = b.state("q", {3});
  const SX v = b.state("v", {0});
  b.dynamics("q", v);
  b.dynamics("v", -q - 0.4 * b.sign(v));
  const auto result = run(b, 15);
  ASSERT_EQ(result.events.size(), 5U);
  for (const auto& event : result.events) {
    EXPECT_EQ(std::count(result.trajectory.t.begin(), result.trajectory.t.end(), event.t), 2) << event.t;
  }
  EXPECT_EQ(result.trajectory.t.back(), 15.0);
  EXPECT_TRUE(std::is_sorted(result.trajectory.t.begin(), result.trajectory.t.end()));
}

TEST(Behaviour, WhatIsNotFiniteIsNamed) {
  const auto message = [](const auto& state) {
    Builder b("undefined");
    state(b);
    const auto result = run(b, 2);
    EXPECT_EQ(result.status.termination, Termination::evaluation_failed);
    return result.status.message;
  };
  EXPECT_NE(message([](Builder& b) {
              const SX a = b.state("a", {1}), deep = b.state("deep", {0});
              b.dynamics("a", -a);
              b.dynamics("deep", 1 / deep);
            }).find("of 'deep' (inf) is not finite at t = 0;"),
            std::string::npos);
  const auto beyond = message([](Builder& b) {
    b.dynamics("a", -b.state("a", {1}));
    b.dynamics("deep", 0.1 * b.state("deep", {0}) + sqrt(1 - b.state("clock", {0})));
    b.dynamics("clock", 1);
  });
  EXPECT_NE(beyond.find("of 'deep' (nan) is not finite beyond t = "), std::string::npos) << beyond;
  const auto many = message([](Builder& b) {
    for (const auto* name : {"a", "b", "c", "d", "e"}) b.dynamics(name, log(b.state(name, {-1})));
  });
  EXPECT_NE(many.find("'a' (nan), 'b' (nan), 'c' (nan) and 2 more"), std::string::npos) << many;
}

}  // namespace
}  // namespace saltus::event_integrator
