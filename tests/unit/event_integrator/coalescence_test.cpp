// Sliding on two surfaces that ends where its root meets the other one.
#include <cmath>

#include <gtest/gtest.h>

#include "run_model.hpp"

namespace saltus::event_integrator {
namespace {

using casadi::SX;
using model::Builder;

/// Slides on u = v = 0 with both selections lambda = z: v' = lambda_v - lambda_u, u' = 1 - y - lambda_u lambda_v, so
/// that z^2 = 1 - y, and det G = 2 z.
Integration slide_to_the_fold(ode::Method method, double rtol, double y, const auto& rate) {
  Builder b("fold");
  const SX u = b.state("u", {0});
  const SX v = b.state("v", {0});
  const SX height = b.state("y", {y});
  const SX lambda_u = b.sign(b.switching("su", u)), lambda_v = b.sign(b.switching("sv", v));
  b.dynamics("u", 1 - height - lambda_u * lambda_v);
  b.dynamics("v", lambda_u - lambda_v);
  b.dynamics("y", rate(b, lambda_u));
  IntegrationOptions options;
  options.method = method;
  options.tolerances = {rtol, 1e-2 * rtol};
  options.until = 1.5;
  options.initial_mode = {{0, 0}, {1, 0}};
  return testing::run_model(b, options);
}

/// When the sliding on both ends.
double end_of_sliding(const Integration& run) {
  for (const auto& event : run.events) {
    if (event.mode_before && *event.mode_before == result::Mode{0, 0}) return event.t;
  }
  return run.status.time_reached;
}

TEST(Coalescence, WhereDetGVanishesLikeTheTimeLeftItsTimeIsNotTheRootOfTheTolerance) {
  // y' = 2 a(t) z: z' = -a, z reaches 0 with this speed at t = 1 for a = 1/2 + sin(3 t) / 4. An error e of y made there
  // ends the sliding sqrt(e) / a(1) early: 6e-5 for the tenth of rtol = 1e-8 that a step may leave; 6e-7 for 1e-13.
  const double a_1 = 0.5 + 0.25 * std::sin(3.0);
  const double z = 0.5 + (1.0 - std::cos(3.0)) / 12.0;
  const auto rate = [](Builder& b, const SX& lambda) { return 2 * (0.5 + 0.25 * sin(3 * b.time())) * lambda; };
  for (const auto method : {ode::Method::dopri5, ode::Method::dop853}) {
    for (const double rtol : {1e-6, 1e-8, 1e-10}) {
      const auto run = slide_to_the_fold(method, rtol, 1.0 - z * z, rate);
      // What was wrong by rtol before that adds its part.
      EXPECT_NEAR(end_of_sliding(run), 1.0, 10.0 * (std::sqrt(1e-13) / a_1 + rtol)) << rtol;
      EXPECT_LT(run.statistics.steps, 400) << rtol;
    }
  }
}

TEST(Coalescence, WhereDetGVanishesLikeTheRootOfTheTimeLeftItCostsFewSteps) {
  // y' = 1/2 - z / 4: the time is the integral of 2 z / (1/2 - z / 4) from 0 to z(0).
  const double z = 0.6;
  const double wanted = -8.0 * z - 16.0 * std::log(1.0 - z / 2.0);
  const auto rate = [](Builder&, const SX& lambda) { return 0.5 - lambda / 4; };
  for (const auto method : {ode::Method::dopri5, ode::Method::dop853}) {
    const auto run = slide_to_the_fold(method, 1e-8, 1.0 - z * z, rate);
    EXPECT_NEAR(end_of_sliding(run), wanted, 1e-7);
    EXPECT_LT(run.statistics.steps, 120);
  }
}

/// Slides on a = b = c = 0 with lambda_a = 5/4 lambda_b and 5/4 lambda_b^2 = 0.3 - y, y' = 0.7: the root is double at
/// t = 3/7. Behind it b, then a go off to the side -side, with lambda_c = -1/10 at first, a' = -side/4, b' = -side (0.7
/// + y).
Integration slide_on_three(int side) {
  Builder b("fold of three");
  const SX x = b.state("a", {0}), y = b.state("b", {0}), z = b.state("c", {0}), height = b.state("y", {0});
  const SX lambda_a = b.sign(b.switching("sa", x)), lambda_b = b.sign(b.switching("sb", y)),
           lambda_c = b.sign(b.switching("sc", z));
  const SX balance = lambda_c - 0.3 * side * lambda_a - 0.2 - 0.5 * (height - 0.3);
  b.dynamics("a", 1.25 * lambda_b - lambda_a + 0.1 * balance);
  b.dynamics("b", side * (0.3 - height - lambda_a * lambda_b));
  b.dynamics("c", -balance);
  b.dynamics("y", SX(0.7));
  IntegrationOptions options;
  options.until = 1.0;
  options.initial_mode = {{0, 0}, {1, 0}, {2, 0}};
  return testing::run_model(b, options);
}

TEST(Coalescence, OfThreeSurfacesIsLeftToTheSideThatTheFieldsTurnTo) {
  // Steps shrink to nothing on the way, over which no field changes: the way out is that of the fields a little later.
  for (const int side : {1, -1}) {
    const auto run = slide_on_three(side);
    ASSERT_EQ(run.status.termination, result::Termination::completed) << run.status.message;
    ASSERT_EQ(run.events.size(), 2U);
    // The roots are apart by the square root of the time left; nearer than 1e-6 Newton's method tells them no longer.
    EXPECT_NEAR(run.events[1].t, 3.0 / 7.0, 1e-11);
    EXPECT_EQ(run.events[1].mode_after, (result::Mode{-side, -side, 0}));
    ASSERT_TRUE(run.events[1].alpha_after.has_value());
    EXPECT_NEAR((*run.events[1].alpha_after)[2], 0.45, 1e-12);
    // No other mode has its field point away from c = 0 or from where it is; the double root is the last one.
    EXPECT_EQ(run.events[1].unique, true);
    EXPECT_TRUE(run.events[1].alternatives.empty());
    const double* x = run.trajectory.x.back().data();
    EXPECT_NEAR(x[0], -side / 7.0, 1e-10);
    EXPECT_NEAR(x[1], -side * 24.0 / 35.0, 1e-10);  // 4/7 + 0.35 (4/7)^2
    EXPECT_NEAR(x[2], 0.0, 1e-14);
  }
}

}  // namespace
}  // namespace saltus::event_integrator
