// Dry friction in a plane, written in right-hand sides.
#include <array>
#include <cmath>
#include <functional>
#include <vector>

#include "run_model.hpp"

namespace saltus::event_integrator::testing {
namespace {

using casadi::SX;
using result::ContactMode;
using result::EventKind;

constexpr double friction = 0.3 * 9.81;

/// A puck with the velocity (3, 2) on a table.
struct Puck {
  model::Builder model{"puck"};
  SX x, y, vx, vy;

  explicit Puck(double speed_x = 3.0, double speed_y = 2.0) {
    x = model.state("x", {0.0});
    y = model.state("y", {0.0});
    vx = model.state("vx", {speed_x});
    vy = model.state("vy", {speed_y});
    model.dynamics("x", vx);
    model.dynamics("y", vy);
  }
};

/// Other forces, the velocity of the table, and how the norm is written.
Integration run_puck(const std::function<SX(const SX&, const SX&)>& norm, ode::Method method = ode::Method::dop853) {
  Puck puck;
  const SX speed = norm(puck.vx, puck.vy);
  puck.model.dynamics("vx", -friction * puck.vx / speed);
  puck.model.dynamics("vy", -friction * puck.vy / speed);
  IntegrationOptions options;
  options.method = method;
  options.tolerances = {1e-10, 1e-12};
  options.until = 3.0;
  return run_model(puck.model, options);
}

TEST(WrittenFriction, APuckStopsAndStays) {
  const auto hypot_of = [](const SX& a, const SX& b) {
    return SX(casadi::SXElem::binary(casadi::OP_HYPOT, a.scalar(), b.scalar()));
  };
  const auto root_of = [](const SX& a, const SX& b) { return sqrt(a * a + b * b); };
  const double v = std::sqrt(13.0), stop = v / friction, way = 0.5 * v * stop;
  for (const std::function<SX(const SX&, const SX&)>& norm :
       {std::function<SX(const SX&, const SX&)>(hypot_of), std::function<SX(const SX&, const SX&)>(root_of)}) {
    for (const auto method : {ode::Method::dopri5, ode::Method::dop853, ode::Method::radau5, ode::Method::taylor}) {
      const auto run = run_puck(norm, method);
      ASSERT_EQ(run.status.termination, result::Termination::completed) << run.status.message;
      ASSERT_EQ(run.events.size(), 1U);
      EXPECT_EQ(run.events[0].kind, EventKind::stick);
      EXPECT_EQ(run.events[0].surfaces, std::vector<std::string>{"friction of vx, vy"});
      EXPECT_NEAR(run.events[0].t, stop, 1e-9);
      ASSERT_EQ(run.final.x.size(), 4U);
      EXPECT_NEAR(run.final.x[0], way * 3.0 / v, 1e-9);
      EXPECT_NEAR(run.final.x[1], way * 2.0 / v, 1e-9);
      EXPECT_EQ(run.final.x[2], 0.0);
      EXPECT_EQ(run.final.x[3], 0.0);
    }
  }
}

/// It stays while the force is smaller than friction, and leaves along it.
TEST(WrittenFriction, AForceThatGrowsMovesThePuck) {
  Puck puck(0.0, 0.0);
  const SX speed = sqrt(puck.vx * puck.vx + puck.vy * puck.vy), t = puck.model.time();
  puck.model.dynamics("vx", 0.6 * 2.0 * t - friction * puck.vx / speed);
  puck.model.dynamics("vy", -0.8 * 2.0 * t - friction * puck.vy / speed);
  const auto run = run_model(puck.model, 2.5, {1e-8, 1e-10});
  ASSERT_EQ(run.status.termination, result::Termination::completed) << run.status.message;
  ASSERT_EQ(run.events.size(), 1U);
  EXPECT_EQ(run.events[0].kind, EventKind::slip);
  const double start = 0.5 * friction;
  EXPECT_NEAR(run.events[0].t, start, 1e-10);
  const double gained = (2.5 - start) * (2.5 - start);
  EXPECT_NEAR(run.final.x[2], 0.6 * gained, 1e-7);
  EXPECT_NEAR(run.final.x[3], -0.8 * gained, 1e-7);
}

/// On a belt it comes to rest on the belt.
TEST(WrittenFriction, ABeltTakesThePuckAlong) {
  Puck puck(0.0, 2.0);
  const double belt = 1.5;
  const SX slip = puck.vx - belt, speed = sqrt(slip * slip + puck.vy * puck.vy);
  puck.model.dynamics("vx", -friction * slip / speed);
  puck.model.dynamics("vy", -friction * puck.vy / speed);
  const auto run = run_tightly(puck.model, 2.0);
  ASSERT_EQ(run.status.termination, result::Termination::completed) << run.status.message;
  ASSERT_EQ(run.events.size(), 1U);
  EXPECT_NEAR(run.events[0].t, 2.5 / friction, 1e-10);
  EXPECT_NEAR(run.final.x[2], belt, 1e-12);
  EXPECT_EQ(run.final.x[3], 0.0);
}

constexpr ode::Method all_methods[] = {ode::Method::dopri5, ode::Method::dop853, ode::Method::taylor,
                                       ode::Method::radau5, ode::Method::radau9, ode::Method::radau13};

/// A puck on a belt, under another force that depends on time.
Integration run_on_belt(const std::array<double, 2>& start, const std::array<double, 2>& belt,
                        const std::array<double, 2>& pull, IntegrationOptions options) {
  Puck puck(start[0], start[1]);
  const SX a = puck.vx - belt[0], b = puck.vy - belt[1], speed = sqrt(a * a + b * b), t = puck.model.time();
  puck.model.dynamics("vx", pull[0] * t - friction * a / speed);
  puck.model.dynamics("vy", pull[1] * t - friction * b / speed);
  options.max_steps = 3000;
  return run_model(puck.model, options);
}

/// Errors of a step are relative to the velocity of the belt, and slips end below them.
TEST(WrittenFriction, ASlipEndsOnABeltThatIsFaster) {
  const double length = std::hypot(1.0, 0.7), stop = length / friction;
  for (const auto method : all_methods) {
    for (const double rtol : {1e-5, 1e-6, 1e-8, 1e-10, 1e-12}) {
      IntegrationOptions options;
      options.method = method;
      options.tolerances = {rtol, 1e-2 * rtol};
      options.until = 1.5;
      const auto run = run_on_belt({0.0, 1.2}, {1.0, 0.5}, {0.0, 0.0}, options);
      ASSERT_EQ(run.status.termination, result::Termination::completed) << run.status.message << rtol;
      ASSERT_EQ(run.events.size(), 1U);
      EXPECT_EQ(run.events[0].kind, EventKind::stick);
      EXPECT_NEAR(run.events[0].t, stop, 2.0 * rtol + 1e-11);
      EXPECT_NEAR(run.final.x[0], 1.5 - 0.5 * stop, 2.0 * rtol + 1e-11);
      EXPECT_NEAR(run.final.x[1], 0.75 + 0.5 * 0.7 * stop, 2.0 * rtol + 1e-11);
      EXPECT_EQ(run.final.x[2], 1.0);
      EXPECT_EQ(run.final.x[3], 0.5);
    }
  }
}

/// Of w/|w| the size of w is nobody's business.
TEST(WrittenFriction, AUnitOfTheSlipDoesNotMatter) {
  for (const double unit : {1e-3, 1e3}) {
    Puck puck(0.0, 1.2);
    const SX a = unit * (puck.vx - 1.0), b = unit * (puck.vy - 0.5), speed = sqrt(a * a + b * b);
    puck.model.dynamics("vx", -friction * a / speed);
    puck.model.dynamics("vy", -friction * b / speed);
    IntegrationOptions options;
    options.method = ode::Method::dop853;
    options.tolerances = {1e-12, 1e-14};
    options.until = 1.5;
    options.max_steps = 3000;
    const auto run = run_model(puck.model, options);
    ASSERT_EQ(run.status.termination, result::Termination::completed) << run.status.message;
    EXPECT_NEAR(run.events[0].t, std::hypot(1.0, 0.7) / friction, 1e-11);
  }
}

TEST(WrittenFriction, AForceMovesThePuckOffItsBelt) {
  const double start = friction / std::sqrt(5.0), left = 3.0 - start;
  for (const auto method : all_methods) {
    IntegrationOptions options;
    options.method = method;
    options.until = 3.0;
    const auto run = run_on_belt({1.0, 0.5}, {1.0, 0.5}, {2.0, 1.0}, options);
    ASSERT_EQ(run.status.termination, result::Termination::completed) << run.status.message;
    ASSERT_EQ(run.events.size(), 1U);
    EXPECT_EQ(run.events[0].kind, EventKind::slip);
    EXPECT_NEAR(run.events[0].t, start, 1e-9);
    EXPECT_NEAR(run.final.x[0], 3.0 + left * left * left / 3.0, 1e-8);
    EXPECT_NEAR(run.final.x[1], 1.5 + left * left * left / 6.0, 1e-8);
    EXPECT_NEAR(run.final.x[2], 1.0 + left * left, 1e-8);
    EXPECT_NEAR(run.final.x[3], 0.5 + 0.5 * left * left, 1e-8);
  }
}

/// The puck slides until it is as fast as the belt again, whether time or place changes that.
TEST(WrittenFriction, ABeltChangesItsSpeedAtOnce) {
  for (const bool in_time : {true, false}) {
    Puck puck(1.0, 0.0);
    const SX passed = puck.model.step((in_time ? puck.model.time() : puck.x) - 1.0), a = puck.vx - 1.0 - 2.0 * passed;
    const SX speed = sqrt(a * a + puck.vy * puck.vy);
    puck.model.dynamics("vx", -friction * a / speed);
    puck.model.dynamics("vy", -friction * puck.vy / speed);
    const auto run = run_tightly(puck.model, 3.0);
    ASSERT_EQ(run.status.termination, result::Termination::completed) << run.status.message;
    const double lasts = 2.0 / friction;
    std::vector<EventKind> kinds;
    for (const auto& event : run.events) {
      if (event.kind != EventKind::crossing) kinds.push_back(event.kind);
    }
    ASSERT_EQ(kinds, (std::vector<EventKind>{EventKind::slip, EventKind::stick}));
    EXPECT_NEAR(run.events[run.events.size() - 1].t, 1.0 + lasts, 1e-9);
    EXPECT_NEAR(run.final.x[0], 1.0 + 6.0 - lasts, 1e-9);
    EXPECT_NEAR(run.final.x[2], 3.0, 1e-12);
  }
}

/// A norm that gives no direction, or pushes along it, is left alone.
TEST(WrittenFriction, OtherNormsAreLeftAlone) {
  for (const bool drag : {true, false}) {
    Puck puck;
    const SX speed = sqrt(puck.vx * puck.vx + puck.vy * puck.vy);
    puck.model.dynamics("vx", drag ? SX(-0.1 * puck.vx * speed) : SX(puck.vx / speed));
    puck.model.dynamics("vy", drag ? SX(-0.1 * puck.vy * speed) : SX(puck.vy / speed));
    const auto system = puck.model.build();
    ASSERT_TRUE(system.has_value()) << system.error().message;
    EXPECT_TRUE(system->contacts.empty());
  }
}

}  // namespace
}  // namespace saltus::event_integrator::testing
