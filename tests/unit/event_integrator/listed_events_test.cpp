// [[events]] where their expressions are no more than the errors of the steps: what is listed there, and what is not.
#include <cmath>
#include <string>

#include "run_model.hpp"

namespace saltus::event_integrator {
namespace {

using casadi::SX;
using model::Builder;
using result::EventKind;
using result::Termination;

constexpr ode::Tolerances default_tolerances{1e-8, 1e-10};

Integration run(Builder& builder, double until, ode::Method method, ode::Tolerances tolerances = default_tolerances) {
  IntegrationOptions options;
  options.method = method;
  options.tolerances = tolerances;
  options.until = until;
  return testing::run_model(builder, options);
}

std::vector<double> times_of(const Integration& run) {
  std::vector<double> times;
  for (const auto& event : run.events) {
    if (event.kind == EventKind::user) times.push_back(event.t);
  }
  return times;
}

void expect_none(const Integration& run, const std::string& what) {
  EXPECT_EQ(run.status.termination, Termination::completed) << what << ": " << run.status.message;
  EXPECT_EQ(times_of(run), std::vector<double>{}) << what;
}

/// All that is left of a state that decays are errors of both signs, at every step.
TEST(ListedEvents, WhatDecaysHasNoZero) {
  for (const auto method : testing::every_method) {
    for (const double rate : {1.0, 5.0, 40.0}) {
      for (const double tolerance : {1e-4, 1e-8, 1e-11}) {
        for (const auto direction : {model::Direction::both, model::Direction::up, model::Direction::down}) {
          Builder b("decay");
          const SX v = b.state("v", {-0.5});
          b.dynamics("v", -rate * v);
          b.event(v, {"itself", direction});
          b.event(3e5 * v, {"scaled", direction});
          b.event(pow(v, 3), {"cube", direction});
          b.event(model::less(v, 0.0), {"below", direction});
          expect_none(run(b, 60.0, method, {tolerance, 0.01 * tolerance}),
                      std::to_string(static_cast<int>(method)) + " " + std::to_string(rate));
        }
      }
    }
  }
}

TEST(ListedEvents, WhatComesToRestHasNoZero) {
  for (const auto method : testing::every_method) {
    Builder b("approach");
    const SX x = b.state("x", {0.0});
    const SX y = b.state("y", {2000.0});
    const SX v = b.state("v", {1.0});
    b.dynamics("x", v);
    b.dynamics("y", 3.0 * (1000.0 - y));
    b.dynamics("v", -v / 0.2);
    b.event(v);
    b.event(y - 1000.0);
    b.event(v * (1.0 + x * x));
    expect_none(run(b, 60.0, method), std::to_string(static_cast<int>(method)));
  }
}

/// Modes and jumps that have nothing to do with it read its sign where they begin.
TEST(ListedEvents, ModesAndJumpsReadNoErrors) {
  for (const auto method : testing::every_method) {
    Builder b("decay beside a relay");
    const SX v = b.state("v", {-0.5});
    const SX x = b.state("x", {1.0});
    const SX n = b.state("n", {0.0});
    b.dynamics("v", -40.0 * v);
    b.dynamics("x", -b.sign(x - sin(3.0 * b.time())));
    b.dynamics("n", 1.0);
    b.jump_every(0.37, {{"n", 0.5 * n}});
    b.event(v);
    expect_none(run(b, 40.0, method), std::to_string(static_cast<int>(method)));
  }
}

/// x'' = -0.2 x' - 1.01 x: zeros every pi, of an amplitude that shrinks to the tolerance.
TEST(ListedEvents, ADecayingOscillationHasItsZerosDownToTheTolerance) {
  for (const auto method : testing::every_method) {
    Builder b("oscillation");
    const SX x = b.state("x", {0.0});
    const SX v = b.state("v", {1.0});
    b.dynamics("x", v);
    b.dynamics("v", -0.2 * v - 1.01 * x);
    b.event(x);
    const auto result = run(b, 300.0, method);
    ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
    const auto times = times_of(result);
    const double pi = std::acos(-1.0);
    ASSERT_GE(times.size(), 60U);  // exp(-6 pi) is a hundred times atol
    for (std::size_t k = 0; k < 60; ++k) {
      const double t = static_cast<double>(k + 1) * pi;
      EXPECT_NEAR(times[k], t, 1e-9 + 1e-9 * std::exp(0.1 * t)) << k;
    }
  }
}

/// Steps that change it by a hundredth of their errors.
TEST(ListedEvents, ASlowZeroIsNotLost) {
  Builder b("slow");
  const SX x = b.state("x", {-1e-8});
  b.dynamics("x", 1e-8);
  b.event(x);
  b.event(b.time() - 1.0, {"time"});
  IntegrationOptions options;
  options.tolerances = default_tolerances;
  options.until = 2.0;
  options.max_step = 1e-5;
  const auto result = testing::run_model(b, options);
  const auto times = times_of(result);
  ASSERT_EQ(times.size(), 2U);
  for (const double t : times) EXPECT_NEAR(t, 1.0, 2e-3);  // a tenth of atol over the rate
}

/// An expression that is affine in nothing, with a gradient that is another one at every place.
TEST(ListedEvents, ASteepExpressionHasItsZeroWhereItIs) {
  for (const auto method : testing::every_method) {
    Builder b("steep");
    const SX x = b.state("x", {1.0});
    b.dynamics("x", -1.0);
    b.event(exp(30.0 * x) - 1.0);
    b.event(1.0 - exp(-30.0 * x));
    const auto times = times_of(run(b, 2.5, method));
    ASSERT_EQ(times.size(), 2U);
    for (const double t : times) EXPECT_NEAR(t, 1.0, 1e-12);
  }
}

/// Users may list what they like, as often as they like: it is no accumulation of switches.
TEST(ListedEvents, ManyAtNearlyOneTimeEndNothing) {
  Builder b("many");
  const SX x = b.state("x", {0.0});
  b.dynamics("x", 1.0);
  for (int k = 0; k < 600; ++k) b.event(x - (0.5 + 1e-12 * k));
  const auto result = run(b, 1.0, ode::Method::dopri5);
  EXPECT_EQ(result.status.termination, Termination::completed) << result.status.message;
  ASSERT_EQ(result.events.size(), 600U);
  for (std::size_t k = 0; k < 600; ++k) EXPECT_NEAR(result.events[k].t, 0.5 + 1e-12 * static_cast<double>(k), 1e-15);
}

TEST(SampledExit, BehindALongStepIsLocatedWithoutCuttingIt) {
  // A block that stands under a drive 0.5 t + 0.3 sin(t) < 1: no state changes, so that a step of half the run is one
  // that the tolerances allow, over which the exits are no polynomials of degree 8. It slips where the drive is 1.
  for (const auto method : {ode::Method::dopri5, ode::Method::dop853}) {
    Builder b("exit");
    const SX v = b.state("v", {0.0});
    const SX t = b.time();
    b.dynamics("v", 0.5 * t + 0.3 * sin(t) - b.sign(v));
    IntegrationOptions options;
    options.method = method;
    options.tolerances = {1e-8, 1e-10};
    options.until = 5.0;
    const auto result = testing::run_model(b, options);
    ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
    ASSERT_EQ(result.events.size(), 2U);
    double exit = 1.5;
    for (int k = 0; k < 20; ++k) exit -= (0.5 * exit + 0.3 * std::sin(exit) - 1.0) / (0.5 + 0.3 * std::cos(exit));
    EXPECT_NEAR(result.events[1].t, exit, 4e-15);  // four roundings of t; the state stands still whatever the step
    EXPECT_EQ(result.events[1].kind, EventKind::leave_sliding);
    // 293 to 312; a cut adds eighteen places with the fields of both sides.
    EXPECT_LT(result.statistics.rhs_evaluations, 330);
  }
}

}  // namespace
}  // namespace saltus::event_integrator
