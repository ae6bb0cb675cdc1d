#include "saltus/event_integrator/integrate.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <gtest/gtest.h>

#include "systems.hpp"

namespace saltus::event_integrator {
namespace {

using casadi::SX;
using result::EventKind;
using result::Termination;

Integration run(const model::System& system, double until, double rtol = 1e-10,
                ode::Method method = ode::Method::dop853) {
  auto kernel = evaluation::ModelKernel::compile(system);
  EXPECT_TRUE(kernel.has_value());
  IntegrationOptions options;
  options.method = method;
  options.tolerances = {rtol, rtol / 100};
  options.until = until;
  return integrate(*kernel, options);
}

TEST(Integrate, CrossesAtTheExactTime) {
  const auto result = run(testing::sign_system(2, -1, -1), 1.0);
  ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
  ASSERT_EQ(result.events.size(), 1U);
  EXPECT_EQ(result.events[0].kind, EventKind::crossing);
  EXPECT_NEAR(result.events[0].t, 1.0 / 3.0, 1e-15);
  EXPECT_NEAR(result.final.x[0], 2.0 / 3.0, 1e-15);
}

TEST(Integrate, EntersSlidingAndStaysExactlyAtZero) {
  const auto result = run(testing::sign_system(0, -1, -1), 2.0);
  ASSERT_EQ(result.events.size(), 1U);
  EXPECT_EQ(result.events[0].kind, EventKind::enter_sliding);
  EXPECT_EQ(result.final.x[0], 0.0);
  EXPECT_EQ(result.final.mode, (result::Mode{0}));
  EXPECT_DOUBLE_EQ(result.final.alpha[0], 0.5);
}

TEST(Integrate, LeavesSlidingTangentially) {
  auto system = testing::sign_system(0, -1, 0);
  system.f = system.f + system.t;
  system.f_as_written = system.f;
  const auto result = run(system, 1.5);
  ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
  ASSERT_EQ(result.events.size(), 2U);
  EXPECT_EQ(result.events[0].kind, EventKind::start);
  EXPECT_EQ(result.events[1].kind, EventKind::leave_sliding);
  EXPECT_NEAR(result.events[1].t, 1.0, 1e-15);
  EXPECT_NEAR(result.final.x[0], 0.125, 1e-15);
}

TEST(Integrate, SpontaneousSwitchIsReportedAsNotUnique) {
  const auto result = run(testing::sign_system(0, 1, 0), 1.0);
  ASSERT_EQ(result.events.size(), 1U);
  EXPECT_EQ(result.events[0].kind, EventKind::start);
  EXPECT_EQ(result.events[0].unique, std::optional<bool>(false));
  EXPECT_EQ(result.events[0].alternatives.size(), 2U);
  EXPECT_NEAR(result.final.x[0], 1.0, 1e-14);
}

TEST(Integrate, RowsAtASwitchHaveTheModesBeforeAndBehindIt) {
  for (const auto method : {ode::Method::dopri5, ode::Method::dop853, ode::Method::taylor}) {
    const auto result = run(testing::stick_slip(), 40, 1e-9, method);
    ASSERT_GE(result.events.size(), 4U);
    const auto& rows = result.trajectory;
    for (const auto& event : result.events) {
      const auto before =
          static_cast<std::size_t>(std::lower_bound(rows.t.begin(), rows.t.end(), event.t) - rows.t.begin());
      ASSERT_LT(before + 1, rows.t.size());
      EXPECT_EQ(rows.t[before + 1], event.t);
      EXPECT_EQ(rows.mode[before], event.mode_before) << event.t;
      EXPECT_EQ(rows.alpha[before], event.alpha_before) << event.t;
      EXPECT_EQ(rows.mode[before + 1], event.mode_after) << event.t;
      EXPECT_EQ(rows.alpha[before + 1], event.alpha_after) << event.t;
    }
  }
}

TEST(Integrate, StickSlipMatchesTheReference) {
  for (const auto method : {ode::Method::dopri5, ode::Method::dop853, ode::Method::taylor}) {
    const auto result = run(testing::stick_slip(), 40, 1e-12, method);
    ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
    ASSERT_GE(result.events.size(), 4U);
    EXPECT_NEAR(result.events[0].t, 0.2446888017833, 1e-11);
    EXPECT_NEAR(result.events[1].t, 4.9321999843006, 1e-11);
    EXPECT_NEAR(result.events[1].x[0], 1.0, 1e-11);
    EXPECT_NEAR(result.events[3].t, 14.1629704423835, 1e-10);
    EXPECT_NEAR(result.final.x[0], 0.62894363667354, 1e-10);
    EXPECT_EQ(result.final.x[1], 0.2);
  }
}

TEST(Integrate, ScalingPsiByPowersOfTwoChangesNoBit) {
  const auto one = run(testing::stick_slip(), 20);
  for (const double scale : {std::ldexp(1.0, 26), std::ldexp(1.0, -26)}) {
    const auto scaled = run(testing::stick_slip(scale), 20);
    ASSERT_EQ(one.events.size(), scaled.events.size());
    for (std::size_t i = 0; i < one.events.size(); ++i) EXPECT_EQ(one.events[i].t, scaled.events[i].t);
    EXPECT_EQ(one.final.x, scaled.final.x);
    EXPECT_EQ(one.final.alpha, scaled.final.alpha);
  }
}

TEST(Integrate, RelayHas34EventsAtEveryTolerance) {
  for (const auto method : {ode::Method::dopri5, ode::Method::dop853, ode::Method::taylor}) {
    for (int k = 0; k <= 40; ++k) {
      const double rtol = std::pow(10.0, -3.0 - 9.0 * k / 40.0);
      const auto result = run(testing::relay(), 10, rtol, method);
      EXPECT_EQ(result.status.termination, Termination::completed) << result.status.message << " rtol " << rtol;
      // The start lies on the surface: its start event comes on top of the 34 switches.
      EXPECT_EQ(result.events.size(), 35U) << "rtol " << rtol << " method " << static_cast<int>(method);
    }
  }
}

TEST(Integrate, ThreeFrictionLawsStickOneAfterTheOther) {
  const auto result = run(testing::friction_blocks(), 12, 1e-12);
  ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
  ASSERT_EQ(result.events.size(), 8U);
  const double times[] = {0.204751747825, 0.248703849480, 1.788631301583, 1.902911374264,
                          2.144794496510, 3.491633368473, 3.641696748668, 3.927104415444};
  for (std::size_t i = 0; i < 8; ++i) EXPECT_NEAR(result.events[i].t, times[i], 2e-12);
  EXPECT_EQ(result.final.mode, (result::Mode{0, 0, 0}));
  for (int i = 3; i < 6; ++i) EXPECT_EQ(result.final.x[static_cast<std::size_t>(i)], 0.0);
  EXPECT_NEAR(result.final.x[0], 0.1130808353911, 1e-12);
}

TEST(Integrate, FieldUndefinedBeyondItsOwnSurfaceIsApproachedFromItsSide) {
  // x' = -sqrt(x) above, +1 below: reaches 0 at t = 2 from x = 1 and slides.
  auto system = testing::blank(1, 1);
  testing::add_surface(system, "x", system.x(0));
  const SX upper = casadi::SX::if_else(system.alpha(0) != 0, -sqrt(system.x(0)), 0) * system.alpha(0);
  testing::set_field(system, {upper + (1 - system.alpha(0))}, {1.0});
  const auto result = run(system, 3.0);
  EXPECT_EQ(result.status.termination, Termination::completed) << result.status.message;
  ASSERT_GE(result.events.size(), 1U);
  EXPECT_NEAR(result.events[0].t, 2.0, 1e-7);
}

TEST(Integrate, RowsDoNotChangeStepsThatHaveNoDenseOutput) {
  // dop853 evaluates f for its dense output at 7/9 of the step, too. Around there f is undefined in one of the steps.
  const auto decay = [](double undefined_at, double reach) {
    auto system = testing::blank(1, 0);
    const SX distance = (system.t - undefined_at) / reach;
    testing::set_field(system, {-system.x(0) + 1e-30 * sqrt(distance * distance - 1)}, {1.0});
    return system;
  };
  const auto steps = run(decay(-1.0, 0.1), 3.0).trajectory.t;
  ASSERT_GT(steps.size(), 4U);
  const std::size_t k = steps.size() / 2;
  const double h = steps[k + 1] - steps[k];
  const auto system = decay(steps[k] + 7.0 / 9.0 * h, 1e-3 * h);
  auto kernel = evaluation::ModelKernel::compile(system);
  ASSERT_TRUE(kernel.has_value());
  IntegrationOptions options;
  options.method = ode::Method::dop853;
  options.tolerances = {1e-10, 1e-12};
  options.until = 3.0;
  options.output.rows = OutputTimes::Rows::at_times;
  const auto without = integrate(*kernel, options);
  const double wanted = steps[k] + 0.5 * h;
  options.output.times = {wanted};
  const auto with = integrate(*kernel, options);
  ASSERT_EQ(with.status.termination, Termination::completed) << with.status.message;
  EXPECT_EQ(without.final.x, with.final.x);
  EXPECT_EQ(without.statistics.steps, with.statistics.steps);
  EXPECT_EQ(without.statistics.rejected, with.statistics.rejected);
  // The dense output was tried: otherwise it would have cost three evaluations.
  EXPECT_GT(with.statistics.rhs_evaluations, without.statistics.rhs_evaluations + 20);
  ASSERT_EQ(with.trajectory.t.size(), 3U);
  EXPECT_EQ(with.trajectory.t[1], wanted);
  EXPECT_NEAR(with.trajectory.x[1][0], std::exp(-wanted), 1e-10);
}

// |x1| + |x2| falls at the rate 2.
TEST(Integrate, ASpiralEndsInTheIntersectionAndStaysThere) {
  auto system = testing::blank(2, 2);
  testing::add_surface(system, "x1", system.x(0));
  testing::add_surface(system, "x2", system.x(1));
  const SX s1 = 2 * system.alpha(0) - 1;
  const SX s2 = 2 * system.alpha(1) - 1;
  testing::set_field(system, {-s1 + 2 * s2, -2 * s1 - s2}, {0.3, 1});
  const auto result = run(system, 1.0);
  ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
  EXPECT_GT(result.events.size(), 8U);
  const auto& arrival = result.events.back();
  EXPECT_EQ(arrival.kind, result::EventKind::accumulation);
  EXPECT_NEAR(arrival.t, 0.65, 1e-12);
  EXPECT_EQ(*arrival.mode_after, (result::Mode{0, 0}));
  EXPECT_EQ(result.final.x, (std::vector<double>{0.0, 0.0}));
}

TEST(Integrate, AKernelCanBeUsedAgain) {
  const auto system = testing::stick_slip();
  auto kernel = evaluation::ModelKernel::compile(system);
  ASSERT_TRUE(kernel.has_value());
  IntegrationOptions options;
  options.until = 10.0;
  const auto first = integrate(*kernel, options);
  const auto second = integrate(*kernel, options);
  EXPECT_GT(first.statistics.rhs_evaluations, 0);
  EXPECT_EQ(first.statistics.rhs_evaluations, second.statistics.rhs_evaluations);
  EXPECT_EQ(first.final.x, second.final.x);
}

}  // namespace
}  // namespace saltus::event_integrator
