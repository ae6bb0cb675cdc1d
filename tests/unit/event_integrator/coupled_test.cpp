// Surfaces that influence each other: modes behind their events, where fields are tangent, nested, or of no help.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "run_model.hpp"
#include "saltus/event_integrator/field/mode_field.hpp"
#include "saltus/event_integrator/integrate.hpp"
#include "saltus/model/builder.hpp"

namespace saltus::event_integrator {
namespace {

using casadi::SX;
using model::Builder;
using result::Termination;

Integration run_coupled(Builder& builder, double until, const std::vector<std::pair<int, int>>& forced = {}) {
  IntegrationOptions options;
  options.tolerances = {1e-10, 1e-12};
  options.until = until;
  options.initial_mode = forced;
  return testing::run_model(builder, options);
}

TEST(Coupled, AnExitOnWhichBothFieldsAreTangentGoesWhereTheyTurn) {
  // x' does not depend on alpha_x: sliding on both ends at t = c with alpha_y = 1, and x' = t - c for either alpha_x.
  for (int i = 0; i < 24; ++i) {
    const double c = 1.0 + 0.01 * i;
    Builder b("tangent");
    const SX x = b.state("x", {0});
    const SX y = b.state("y", {0});
    const SX alpha_x = b.step(b.switching("sx", x + 0.3 * y));
    const SX alpha_y = b.step(b.switching("sy", y));
    const SX y_rate = 0.5 + 2 * alpha_x - 2 * alpha_y;
    b.dynamics("x", (1 - alpha_y) + alpha_y * (b.time() - c) - 0.3 * y_rate);
    b.dynamics("y", y_rate);
    const auto result = run_coupled(b, c + 1.0, {{0, 0}, {1, 0}});
    ASSERT_EQ(result.status.termination, Termination::completed) << c << ": " << result.status.message;
    EXPECT_EQ(result.final.mode, (result::Mode{1, 1})) << c;
    EXPECT_NEAR(result.final.x[0] + 0.3 * result.final.x[1], 0.5, 1e-9) << c;
  }
}

TEST(Coupled, BehindACrossingNestedFunctionsHaveTheSelectionsOfTheNewSliding) {
  // Slides on y = 0; sign(z + sign(y)/2) = sign(y) there, which is -0.8 on average for x > 0 and 0.5 for x < 0.
  Builder b("nested");
  const SX x = b.state("x", {1});
  const SX y = b.state("y", {0});
  const SX z = b.state("z", {0.45});
  const SX side = b.sign(y);
  b.dynamics("x", -1 + 1.5 * b.sign(z + 0.5 * side));
  b.dynamics("y", -0.15 - 0.65 * b.sign(x) - side);
  b.dynamics("z", 0);
  const auto result = run_coupled(b, 2);
  ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
  EXPECT_NEAR(result.final.x[0], -0.25 * (2.0 - 1.0 / 2.2), 1e-9);
}

TEST(Coupled, CyclesAboutAnIntersectionThatShrinkLikeAPowerAreSaidToBeOfBothSurfaces) {
  // A centre with damping: each quarter of a cycle from a to a takes about a and loses d a^2 / 2, so that a ~ 1/k.
  Builder b("centre");
  const SX x = b.state("x", {0.5});
  const SX y = b.state("y", {0});
  const SX side_x = b.sign(b.switching("sx", x)), side_y = b.sign(b.switching("sy", y));
  b.dynamics("x", -side_y - 0.7 * x);
  b.dynamics("y", side_x - 0.7 * y);
  IntegrationOptions options;
  options.until = 1e4;
  options.max_events = 1000;
  options.tolerances = {1e-9, 1e-11};
  const auto result = testing::run_model(b, options);
  EXPECT_EQ(result.status.termination, Termination::iteration_limit) << result.status.message;
  const std::string wanted = "cycles of 'sx', 'sy' shrink like the power -1 of";
  EXPECT_NE(result.status.message.find(wanted), std::string::npos) << result.status.message;
}

TEST(Coupled, SurfacesThatCoincideAreSlidOnTogether) {
  // x (1 + y/10) and x vanish together; the drift is held until it is the sum of both forces.
  const double cases[][3] = {{0.5, 1.0, -1.0}, {0.5, 1.0, 1.0}};
  for (const auto& [first, second, start] : cases) {
    Builder b("touch");
    const SX x = b.state("x", {start});
    const SX y = b.state("y", {-2});
    b.dynamics("x", 0.3 * b.time() - first * b.sign(x * (1 + 0.1 * y)) - second * b.sign(x));
    b.dynamics("y", 1);
    const auto result = run_coupled(b, 6);
    ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
    EXPECT_EQ(result.events.back().kind, result::EventKind::leave_sliding);
    EXPECT_NEAR(result.events.back().t, 5.0, 1e-9);
    EXPECT_TRUE(std::isnan((*result.events.back().alpha_before)[0]));
    EXPECT_NEAR(result.final.x[0], 0.15, 1e-9);
  }
}

/// x' = y' = drive - sign(x) - 3 sign(y - y0): both are at 0 together, held by the weighted sum of both selections
/// only.
TEST(Coupled, SurfacesThatMoveAlikeAreHeldByTheirSumUntilTheDriveIsLarger) {
  const double starts[] = {0.0, 0.5};
  for (const double y_0 : starts) {
    for (const double direction : {1.0, -1.0}) {
      for (const auto method : testing::every_method) {
        Builder b("alike");
        const SX x = b.state("x", {1});
        const SX y = b.state("y", {1 + y_0});
        const SX sign_x = b.sign(x);
        const SX rate = direction * b.time() - sign_x - 3 * b.sign(y - y_0);
        b.dynamics("x", rate);
        b.dynamics("y", rate);
        IntegrationOptions options;
        options.method = method;
        options.tolerances = {1e-10, 1e-12};
        options.until = 6;
        const auto result = testing::run_model(b, options);
        ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
        // 1 - 4 t + direction t^2/2 = 0
        const double stop = direction > 0.0 ? 4.0 - std::sqrt(14.0) : std::sqrt(18.0) - 4.0;
        ASSERT_EQ(result.events.size(), 2U);
        EXPECT_NEAR(result.events[0].t, stop, 1e-10);
        EXPECT_EQ(result.events[0].kind, result::EventKind::enter_sliding);
        EXPECT_EQ(result.events[0].unique, true);
        EXPECT_EQ(*result.events[0].mode_after, (result::Mode{0, 0}));
        const auto selections = *result.events[0].alpha_after;
        for (const double alpha : selections) EXPECT_TRUE(std::isnan(alpha)) << alpha;
        EXPECT_NEAR(result.events[1].t, 4.0, 1e-10);
        EXPECT_EQ(result.events[1].kind, result::EventKind::leave_sliding);
        const int side = direction > 0.0 ? 1 : -1;
        EXPECT_EQ(*result.events[1].mode_after, (result::Mode{side, side}));
        EXPECT_NEAR(result.final.x[0], 2.0 * direction, 1e-9);
        EXPECT_NEAR(result.final.x[1], 2.0 * direction + y_0, 1e-9);
      }
    }
  }
}

/// z' = -2 sign(z) - sign(x)/2 beside x' = y'/2 = -sign(x) - 3 sign(y) - sign(z)/4 + drive: two conditions for three
/// selections. At rest |sign(z)| <= 1 leaves all the room that the others want: x and y part from 0 as 4 < t, but for
/// what sign(z) = -1/4 then adds.
TEST(Coupled, OfThreeSurfacesTwoMoveAlike) {
  Builder b("three");
  const SX x = b.state("x", {1});
  const SX y = b.state("y", {2});
  const SX z = b.state("z", {0.125});
  const SX sign_x = b.sign(x);
  const SX sign_y = b.sign(y);
  const SX sign_z = b.sign(z);
  const SX rate = b.time() - sign_x - 3 * sign_y - 0.25 * sign_z;
  b.dynamics("x", rate);
  b.dynamics("y", 2 * rate);
  b.dynamics("z", -2 * sign_z - 0.5 * sign_x);
  const auto result = run_coupled(b, 6);
  ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
  ASSERT_EQ(result.events.size(), 3U);
  EXPECT_NEAR(result.events[0].t, 0.05, 1e-10);
  // From there sign(z) is -1/4: x' = t - 4 + 1/16.
  const double left = 1.0 + 0.05 * (0.025 - 4.25), rate_0 = 0.05 - 4.0 + 0.0625;
  EXPECT_NEAR(result.events[1].t, 0.05 - rate_0 - std::sqrt(rate_0 * rate_0 - 2.0 * left), 1e-9);
  EXPECT_EQ(*result.events[1].mode_after, (result::Mode{0, 0, 0}));
  EXPECT_NEAR(result.events[2].t, 3.9375, 1e-9);
  EXPECT_EQ(*result.events[2].mode_after, (result::Mode{1, 1, 0}));
  EXPECT_NEAR((*result.events[2].alpha_after)[2], 0.375, 1e-9);
  EXPECT_NEAR(result.final.x[0], 0.5 * (6.0 - 3.9375) * (6.0 - 3.9375), 1e-8);
  EXPECT_NEAR(result.final.x[1], 2.0 * result.final.x[0], 1e-8);
}

/// x and y touch 0 with one velocity at t = 1/4, and y - x = 0.1 (t - 1/4)^2: y stays alone.
TEST(Coupled, SurfacesThatMoveAlikeForAnInstantAreNotHeld) {
  Builder b("instant");
  const SX x = b.state("x", {1});
  const SX y = b.state("y", {1.00625});
  const SX sign_x = b.sign(x);
  const SX rate = -sign_x - 3 * b.sign(y);
  b.dynamics("x", rate);
  b.dynamics("y", rate + 0.2 * (b.time() - 0.25));
  const auto result = run_coupled(b, 1);
  ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
  EXPECT_EQ(result.final.mode, (result::Mode{-1, 0}));
  EXPECT_NEAR(result.final.x[0], -0.05625, 1e-9);
}

TEST(Coupled, SlidingOfSecondOrderIsNotTakenForACrossing) {
  // Sliding on both ends with alpha_x = 1, where y' = z for either alpha_y, and z' = 1 - 1.3 alpha_y turns y back.
  Builder b("second order");
  const SX x = b.state("x", {0});
  const SX y = b.state("y", {0});
  const SX z = b.state("z", {-1});
  const SX alpha_x = b.step(x);
  const SX alpha_y = b.step(y);
  b.dynamics("x", 0.2 + alpha_y - 0.9 * alpha_x);
  b.dynamics("y", 2 * (1 - alpha_x) + alpha_x * z);
  b.dynamics("z", 1 - 1.3 * alpha_y);
  const auto result = run_coupled(b, 10, {{0, 0}, {1, 0}});
  EXPECT_TRUE(result.status.termination == Termination::outside_class ||
              result.status.termination == Termination::completed)
      << result.status.message;
  EXPECT_LT(result.events.size(), 10U);
}

TEST(Coupled, OfThreeSurfacesStabilityIsThatOfTheScalingTheSlidingBeganWithToo) {
  // x' = -M(t) (alpha - 1/2): no ordering of M has positive minors (Fisher and Fuller), but -M is stable up to the time
  // at which c1 c2 = c3 (Routh and Hurwitz).
  // Rows of M(0) have the sum 2 of sizes: speeds 1.
  const double a = 0.2, b = 0.8, c = 0.65, d = 1.3, e = 0.2, f = -1.75, g = -0.05;
  const auto routh = [&](double t) {
    const double c1 = (1 + t) + 2 * g;
    const double c2 = 2 * g * (1 + t) - a * c + g * g - d * f - b * e;
    const double c3 = (1 + t) * (g * g - d * f) - a * (c * g - d * e) + b * (c * f - g * e);
    return c1 * c2 - c3;
  };
  double wanted = 0.0, beyond = 2.0;
  ASSERT_GT(routh(wanted), 0.0);
  ASSERT_LT(routh(beyond), 0.0);
  while (beyond - wanted > 1e-12) {
    const double middle = 0.5 * (wanted + beyond);
    (routh(middle) > 0.0 ? wanted : beyond) = middle;
  }
  Builder builder("three");
  const SX x = builder.state("x", {0});
  const SX y = builder.state("y", {0});
  const SX z = builder.state("z", {0});
  const SX u = builder.step(x) - 0.5;
  const SX v = builder.step(y) - 0.5;
  const SX w = builder.step(z) - 0.5;
  builder.dynamics("x", -((1 + builder.time()) * u + a * v + b * w));
  builder.dynamics("y", -(c * u + g * v + d * w));
  builder.dynamics("z", -(e * u + f * v + g * w));
  const auto system = builder.build();
  ASSERT_TRUE(system.has_value());
  auto kernel = evaluation::ModelKernel::compile(*system);
  ASSERT_TRUE(kernel.has_value());
  ModeState state;
  state.mode = {0, 0, 0};
  state.alpha = {0.5, 0.5, 0.5};
  state.sliding = {0, 1, 2};
  ModeField field(*kernel, true);
  field.enter(state);
  const std::vector<double> point(3, 0.0);
  const auto stability_at = [&](double t) {
    std::array<ExitValues, 3> exits;
    field.exits(t, point.data(), exits.data());
    return exits[0].stability;
  };
  EXPECT_GT(stability_at(0.0), 1e-3);
  EXPECT_GT(stability_at(wanted - 1e-9), 0.0);
  EXPECT_LT(stability_at(wanted + 1e-9), 0.0);
}

TEST(Coupled, TheOtherRootOfAModeIsAnAlternativeWhereAScalingDecidesToo) {
  // Slides on x = 0 with lambda_x = -1/2 and y' = 3/4 to y = 0 (leaf E10, and not every scaling slides on both). Of the
  // roots (0, -1/3) has det G = 1/2, (1/4, -1/7) has det G = -1/2.
  for (const auto selection : {switching::SelectionPolicy::active_dominant, switching::SelectionPolicy::scaled}) {
    Builder b("two roots");
    const SX x = b.state("x", {0}), y = b.state("y", {-0.75});
    const SX lambda_x = b.sign(b.switching("sx", x)), lambda_y = b.sign(b.switching("sy", y));
    b.dynamics("x", 0.5 - lambda_x + 1.5 * lambda_y + lambda_x * lambda_y);
    b.dynamics("y", 0.25 - 0.25 * lambda_x + 0.75 * lambda_y + 2.25 * lambda_x * lambda_y);
    IntegrationOptions options;
    options.until = 2.0;
    options.selection = selection;
    options.scaling = {100.0, 1.0};
    const auto result = testing::run_model(b, options);
    ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
    const auto& event = result.events.back();
    EXPECT_NEAR(event.t, 1.0, 1e-12);
    ASSERT_EQ(event.mode_after, (result::Mode{0, 0}));
    EXPECT_NEAR((*event.alpha_after)[1], 1.0 / 3.0, 1e-12);
    EXPECT_EQ(event.unique, false);
    EXPECT_EQ(event.alternatives.size(), 2U);  // and leaving both
    const auto root = std::find_if(event.alternatives.begin(), event.alternatives.end(), [](const auto& other) {
      return other.mode == result::Mode{0, 0};
    });
    ASSERT_NE(root, event.alternatives.end());
    EXPECT_NEAR(root->alpha[0], 5.0 / 8.0, 1e-12);
    EXPECT_NEAR(root->alpha[1], 3.0 / 7.0, 1e-12);
  }
}

TEST(Coupled, OfThreeDependentSurfacesThoseAreLeftThatCannotBeHeldBehindTheExit) {
  // Two blocks that stick to the ground and to each other. The force on the first one grows until that slips: nothing
  // then holds it to the other one either, which stays where it is, by the ground alone.
  for (const auto method : testing::every_method) {
    Builder b("stick of two blocks");
    const SX first = b.state("v0", {0}), second = b.state("v1", {0});
    b.dynamics("v0", b.time() - b.sign(first));
    b.dynamics("v1", -0.4 * b.sign(second) - 0.3 * b.sign(second - first));
    IntegrationOptions options;
    options.method = method;
    options.until = 2;
    const auto result = testing::run_model(b, options);
    ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
    ASSERT_EQ(result.events.size(), 2U);
    EXPECT_NEAR(result.events.back().t, 1.0, 1e-10);
    EXPECT_NEAR(result.final.x[0], 0.5, 1e-7);
    EXPECT_NEAR(result.final.x[1], 0.0, 1e-14);
  }
}

}  // namespace
}  // namespace saltus::event_integrator
