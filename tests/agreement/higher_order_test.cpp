// Higher-order sliding: twisting and super-twisting controllers, what holds behind their limits, and how it ends.
// References are closed forms.
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "problems/simulator.hpp"

namespace saltus::problems {
namespace {

using result::Event;
using result::EventKind;
using result::Result;
using result::Termination;

/// x1' = x2, x2' = -10 (sign(x1) + 0.3 sign(x2)) + a(t), and a third state.
std::string twisting(const std::string& start, const std::string& disturbance, const std::string& z_rate,
                     const std::string& until, double scale = 1.0) {
  return fmt::format(R"toml(
[model]
name = "twisting"
[states]
{0}
z = 0
[switching]
s1 = "{4}*x1"
s2 = "{4}*x2"
[dynamics]
x1 = "x2"
x2 = "-10*(sign(s1) + 0.3*sign(s2)) + {1}"
z = "{2}"
[simulate]
until = {3}
)toml",
                     start, disturbance, z_rate, until, scale);
}

std::vector<Event> of_kind(const Result& result, EventKind kind) {
  std::vector<Event> found;
  for (const Event& event : result.events) {
    if (event.kind == kind) found.push_back(event);
  }
  return found;
}

/// From (10, 10): x2 = 0 after 10/13 at x1 = 10 + 50/13; then half turns that shrink x1 by 7/13, each of duration
/// sqrt(2 x1/13) + sqrt(2 x1 7/13/7)/..., summed as a geometric series.
constexpr double twisting_ends = 12.264208764653927;

TEST(HigherOrder, TwistingReachesTheOriginAndStays) {
  for (const double scale : {1.0, 1e8, 1e-8}) {
    const std::string text = twisting("x1 = 10\nx2 = 10", "0", "1 - z + x1", "15", scale);
    for (const auto& accuracy : {fine, fine_explicit, fine_implicit, standard, implicit}) {
      const Result result = simulate_text(text, accuracy);
      ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
      const auto limits = of_kind(result, EventKind::accumulation);
      ASSERT_EQ(limits.size(), 1U);
      // What the cycles leave behind the extrapolation: their rounding, divided by one minus the ratio.
      EXPECT_NEAR(limits[0].t, twisting_ends, 1e-10);
      EXPECT_EQ(limits[0].surfaces, (std::vector<std::string>{"s1", "s2"}));
      EXPECT_EQ(*limits[0].mode_after, (std::vector<int>{0, 0}));
      EXPECT_NE(limits[0].reason.find("higher-order sliding"), std::string::npos) << limits[0].reason;
      EXPECT_EQ(limits[0].unique, true);
      // One condition for two selections: they are not determined.
      EXPECT_TRUE(std::isnan((*limits[0].alpha_after)[0]) && std::isnan((*limits[0].alpha_after)[1]));
      EXPECT_TRUE(std::isnan(result.final.alpha[0]) && std::isnan(result.final.alpha[1]));
      EXPECT_EQ(result.final.x[0], 0.0);
      EXPECT_EQ(result.final.x[1], 0.0);
      // z goes on: z' = 1 - z.
      const double z = limits[0].x_after[2];
      EXPECT_NEAR(result.final.x[2], 1.0 + (z - 1.0) * std::exp(limits[0].t - 15.0),
                  accuracy.rtol < 1e-10 ? 1e-10 : 1e-7);
    }
  }
}

// Between -13 and 13 some selections hold the disturbance; t passes 13 at both gains together.
TEST(HigherOrder, TwistingLosesAgainstADisturbanceThatGrows) {
  for (const bool reflected : {false, true}) {
    const std::string text = twisting("x1 = 1\nx2 = 0", reflected ? "-t" : "t", "x1", "15");
    for (const auto& accuracy : {fine, fine_explicit, fine_implicit, standard}) {
      const Result result = simulate_text(text, accuracy);
      ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
      const auto exits = of_kind(result, EventKind::leave_sliding);
      ASSERT_EQ(exits.size(), 1U);
      const int side = reflected ? -1 : 1;
      EXPECT_NEAR(exits[0].t, 13.0, 1e-12);
      EXPECT_EQ(*exits[0].mode_before, (std::vector<int>{0, 0}));
      EXPECT_EQ(*exits[0].mode_after, (std::vector<int>{side, side}));
      EXPECT_EQ(result.events.back().t, exits[0].t);
      // x2 = (t - 13)^2/2.
      EXPECT_NEAR(result.final.x[1], side * 2.0, 1e-7);
      EXPECT_NEAR(result.final.x[0], side * 4.0 / 3.0, 1e-7);
    }
  }
}

TEST(HigherOrder, AStartAtTheOriginOfATwistingControllerStays) {
  const Result result = simulate_text(twisting("x1 = 0\nx2 = 0", "2*sin(t)", "1", "5"), fine);
  ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
  ASSERT_EQ(result.events.size(), 1U);
  EXPECT_EQ(result.events[0].kind, EventKind::start);
  EXPECT_EQ(*result.events[0].mode_after, (std::vector<int>{0, 0}));
  EXPECT_EQ(result.final.x[0], 0.0);
  EXPECT_EQ(result.final.x[1], 0.0);
  EXPECT_NEAR(result.final.x[2], 5.0, 1e-12);
}

// The third state takes part in the balance, but which selections hold it would change its motion.
TEST(HigherOrder, AMotionThatDependsOnUndeterminedSelectionsIsOutsideTheClass) {
  const Result result = simulate_text(twisting("x1 = 10\nx2 = 10", "0", "sign(s1)", "15"), standard);
  EXPECT_EQ(result.status.termination, Termination::outside_class);
  EXPECT_NEAR(result.status.time_reached, twisting_ends, 1e-6);
}

// What multiplies both selections alike is determined: u = 10 sign(x1) + 3 sign(x2) equals the disturbance.
TEST(HigherOrder, WhatFollowsFromTheBalanceIsDetermined) {
  const Result result = simulate_text(twisting("x1 = 0\nx2 = 0", "2 + t/2", "10*sign(s1) + 3*sign(s2)", "5"), fine);
  ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
  EXPECT_NEAR(result.final.x[2], 2.0 * 5.0 + 25.0 / 4.0, 1e-9);
}

std::string super_twisting(const std::string& surface, const std::string& disturbance, const std::string& until) {
  return fmt::format(R"toml(
[model]
name = "super-twisting"
[states]
x1 = 0
x2 = 1
z = 0
[switching]
s = "{}"
[dynamics]
x1 = "-1.5*sqrt(abs(s))*sign(s) + x2"
x2 = "-1.1*sign(s) + {}"
z = "x2 + 1"
[simulate]
until = {}
)toml",
                     surface, disturbance, until);
}

// Every half turn shrinks |x2| by r = exp(-pi (k1/4)/sqrt(k2/2 - k1^2/16)); T = (1 + r)/(k2 (1 - r)).
TEST(HigherOrder, SuperTwistingReachesTheOriginAndStays) {
  const double r = std::exp(-M_PI * (1.5 / 4) / std::sqrt(1.1 / 2 - 1.5 * 1.5 / 16));
  const double limit = (1 + r) / (1.1 * (1 - r));
  EXPECT_NEAR(limit, 1.25184528752894, 1e-12);
  for (const auto& accuracy : {fine, fine_explicit, fine_implicit}) {
    const Result result = simulate_text(super_twisting("x1", "0", "3"), accuracy);
    ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
    const auto limits = of_kind(result, EventKind::accumulation);
    ASSERT_EQ(limits.size(), 1U);
    // The field has no Lipschitz constant at the surface, where steps end that are as inaccurate as allowed: dop853 is
    // off by 8 to 16 rtol for rtol from 1e-10 to 1e-12.
    EXPECT_NEAR(limits[0].t, limit, 20e-12);
    EXPECT_EQ(*limits[0].mode_after, (std::vector<int>{0}));
    // x2' = 0 determines the one selection.
    EXPECT_NEAR((*limits[0].alpha_after)[0], 0.5, 1e-12);
    EXPECT_EQ(result.final.x[0], 0.0);
    EXPECT_EQ(result.final.x[1], 0.0);
    EXPECT_NEAR(result.final.x[2], limits[0].x_after[2] + 3.0 - limits[0].t, 1e-10);
  }
  // Not Lipschitz at the surface: loose tolerances cost digits, but no event and no status.
  for (const auto& accuracy : {standard, implicit, Accuracy{pipeline::Integrator::dop853, 1e-6, 1e-8}}) {
    const Result result = simulate_text(super_twisting("x1", "0", "3"), accuracy);
    ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
    EXPECT_NEAR(result.events.back().t, limit, 1e-6);
  }
}

// The integral of the controller follows the disturbance: alpha = 1/2 + d(t)/(2 k2), up to d = k2.
TEST(HigherOrder, TheSelectionOfSuperTwistingFollowsTheDisturbance) {
  const Result result = simulate_text(super_twisting("x1", "0.2*t", "4"), fine);
  ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
  EXPECT_EQ(result.final.mode, (std::vector<int>{0}));
  EXPECT_EQ(result.final.x[0], 0.0);
  EXPECT_EQ(result.final.x[1], 0.0);
  EXPECT_NEAR(result.final.alpha[0], 0.5 + 0.8 / 2.2, 1e-9);
}

// Behind t = 1 the gain 1.1 no longer holds the disturbance. With s = t - 1 and c = (2/15)^2 it is such that
// x1 = c s^4, x2 = 4 c s^3 + 1.5 sqrt(c) s^2: a solution that leaves a surface where its field has no derivative.
TEST(HigherOrder, SuperTwistingLosesAgainstADisturbanceThatGrows) {
  const double c = 4.0 / 225.0;
  for (const int side : {1, -1}) {
    const std::string disturbance = fmt::format("{}*(1.1 + 0.4*(t - 1) + 12*4/225*(t - 1)^2)", side);
    std::string text = super_twisting("x1", disturbance, "3");
    text.replace(text.find("x2 = 1"), 6, "x2 = 0");
    for (const auto& accuracy :
         {fine, fine_explicit, fine_implicit, standard, implicit, Accuracy{pipeline::Integrator::dop853, 1e-6, 1e-8},
          Accuracy{pipeline::Integrator::dopri5, 1e-3, 1e-5}}) {
      const Result result = simulate_text(text, accuracy);
      ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
      ASSERT_EQ(result.events.size(), 2U);
      EXPECT_EQ(result.events[1].kind, EventKind::leave_sliding);
      EXPECT_EQ(*result.events[1].mode_after, (std::vector<int>{side}));
      EXPECT_NEAR(result.events[1].t, 1.0, 1e-10);
      // Errors of x1 decay as the solution is stiff; those of x2 and z are of the size of the tolerance.
      const double tolerance = std::max(1e-10, 3.0 * accuracy.rtol);
      EXPECT_NEAR(result.final.x[0], side * 16.0 * c, tolerance);
      EXPECT_NEAR(result.final.x[1], side * (32.0 * c + 0.8), tolerance);
      // z' = x2 + 1.
      EXPECT_NEAR(result.final.x[2], 3.0 + side * (16.0 * c + 1.6 / 3.0), tolerance);
    }
  }
}

/// Continuous twisting: x and v and then e + 0.2 sin(t) are zero behind one approach along which nothing switches, with
/// roots of both, so that no cycles shrink; where x and v cannot be told from zero any more they are held, with e on
/// -0.2 sin(t), as |0.2 cos(t)| is less than 0.75.
TEST(HigherOrder, ContinuousTwistingIsHeldWhereItIsUnresolved) {
  const std::string text = R"toml(
[model]
name = "m"
[states]
x = 1
v = 0
e = 0
[dynamics]
x = "v"
v = "-2*abs(x)^(1/3)*sign(x)-2.5*sqrt(abs(v))*sign(v)+e+0.2*sin(t)"
e = "-0.5*sign(x)-0.25*sign(v)"
[simulate]
until = 12
)toml";
  const auto arrival = [&](const Accuracy& accuracy) {
    const Result result = simulate_text(text, accuracy);
    EXPECT_EQ(result.status.termination, Termination::completed) << result.status.message;
    const Event& last = result.events.back();
    EXPECT_EQ(last.kind, EventKind::accumulation);
    EXPECT_NE(last.reason.find("zero together"), std::string::npos) << last.reason;
    EXPECT_EQ(*last.mode_after, (std::vector<int>{0, 0}));
    EXPECT_EQ(result.final.x[0], 0.0);
    EXPECT_EQ(result.final.x[1], 0.0);
    EXPECT_NEAR(result.final.x[2], -0.2 * std::sin(12.0), 1e-12);
    // Two selections, one condition.
    EXPECT_TRUE(std::isnan(result.final.alpha[0]) && std::isnan(result.final.alpha[1]));
    return last.t;
  };
  const double exact = arrival({pipeline::Integrator::dop853, 1e-12, 1e-14});
  for (const auto integrator :
       {pipeline::Integrator::dop853, pipeline::Integrator::dopri5, pipeline::Integrator::taylor}) {
    for (const double rtol : {1e-6, 1e-8, 1e-10}) {
      EXPECT_NEAR(arrival({integrator, rtol, 1e-2 * rtol}), exact, rtol);
    }
  }
}

}  // namespace
}  // namespace saltus::problems
