// Contacts whose forces the motion does not determine, and motions that it leaves open with them.
#include <cmath>
#include <functional>
#include <numbers>

#include "run_model.hpp"

namespace saltus::event_integrator::testing {
namespace {

using casadi::SX;
using result::ContactMode;
using result::EventKind;

constexpr double weight = 10.0;
const std::vector<std::string> in_plane{"x", "z"}, rates{"vx", "vz"};

struct Foot {
  const char* name;
  double side, friction;
};

/// A block of height 2 h on two feet, pulled by t: both feet slip along the same direction.
Integration pulled_on_feet(const std::vector<Foot>& feet) {
  model::Builder model("block");
  constexpr double h = 0.2;
  static_cast<void>(model.state("x", {0.0}));
  const SX z = model.state("z", {h}), a = model.state("a", {0.0});
  for (const char* name : {"vx", "vz", "w"}) static_cast<void>(model.state(name, {0.0}));
  model.mechanics({.positions = {"x", "z", "a"},
                   .velocities = {"vx", "vz", "w"},
                   .potential = weight * z,
                   .force = {{"vx", model.time()}}});
  for (const auto& [name, side, friction] : feet) {
    model.contact(name, z + side * sin(a) - h * cos(a), {.tangent = {{"x", 1.0}, {"a", h}}, .friction = friction});
  }
  return run_tightly(model, 5.0);
}

/// The feet carry 5 -+ 0.2 F under a friction of F = 0.2 N_1 + 0.4 N_2 in all, of which each may have any part.
TEST(ContactsWithOpenForces, TwoFeetSlipOnceBothAreAtTheirEdge) {
  const Foot left{"left", -0.5, 0.2}, right{"right", 0.5, 0.4};
  const double limit = 3.0 / (1.0 - 0.2 * (0.4 - 0.2));
  for (const auto& feet : {std::vector{left, right}, std::vector{right, left}}) {
    const auto run = pulled_on_feet(feet);
    ASSERT_EQ(run.status.termination, result::Termination::completed) << run.status.message;
    ASSERT_EQ(run.events.size(), 1U);
    EXPECT_EQ(run.events[0].kind, EventKind::slip);
    EXPECT_NEAR(run.events[0].t, limit, 1e-8);
    EXPECT_EQ(run.events[0].unique, true);
    EXPECT_EQ(run.events[0].contact_modes_after, std::vector<ContactMode>(2, ContactMode::slip));
    EXPECT_NEAR(run.final.x[3], 0.5 * (5.0 - limit) * (5.0 - limit), 1e-8);
  }
}

/// Two contacts at one place: their normal forces are open, and if one of them has more friction, the motion is.
Integration pulled_on_one_place(double first, double second) {
  model::Builder model("block");
  static_cast<void>(model.state("x", {0.0}));
  const SX z = model.state("z", {0.0});
  for (const auto& rate : rates) static_cast<void>(model.state(rate, {0.0}));
  model.mechanics(
      {.positions = in_plane, .velocities = rates, .potential = weight * z, .force = {{"vx", model.time()}}});
  model.contact("one", z, {.tangent = {{"x", 1.0}}, .friction = first});
  model.contact("two", z, {.tangent = {{"x", 1.0}}, .friction = second});
  return run_tightly(model, 5.0);
}

TEST(ContactsWithOpenForces, OfTwoAtOnePlaceFrictionDecidesWhetherTheMotionIsOpen) {
  const auto same = pulled_on_one_place(0.3, 0.3);
  ASSERT_EQ(same.status.termination, result::Termination::completed) << same.status.message;
  ASSERT_EQ(same.events.size(), 1U);
  EXPECT_EQ(same.events[0].kind, EventKind::slip);
  EXPECT_NEAR(same.events[0].t, 3.0, 1e-8);
  EXPECT_EQ(same.events[0].unique, true);
  EXPECT_NEAR(same.final.x[2], 2.0, 1e-8);
  for (const auto& [first, second] : {std::pair{0.2, 0.4}, std::pair{0.4, 0.2}}) {
    const auto run = pulled_on_one_place(first, second);
    ASSERT_EQ(run.status.termination, result::Termination::completed) << run.status.message;
    ASSERT_FALSE(run.events.empty());
    EXPECT_EQ(run.events.back().kind, EventKind::slip);
    EXPECT_EQ(run.events.back().unique, false);
    EXPECT_NE(run.events.back().reason.find("more than one motion"), std::string::npos);
  }
}

/// Between two walls it falls, or any pressure holds it.
TEST(ContactsWithOpenForces, ABlockInAViseMayFallOrNot) {
  model::Builder model("block");
  const SX x = model.state("x", {0.0}), z = model.state("z", {0.0});
  for (const auto& rate : rates) static_cast<void>(model.state(rate, {0.0}));
  model.mechanics({.positions = in_plane, .velocities = rates, .potential = weight * z});
  model.contact("left", x, {.tangent = {{"z", 1.0}}, .friction = 0.5});
  model.contact("right", -x, {.tangent = {{"z", 1.0}}, .friction = 0.5});
  const auto run = run_tightly(model, 1.0);
  ASSERT_EQ(run.status.termination, result::Termination::completed) << run.status.message;
  ASSERT_EQ(run.events.size(), 1U);
  EXPECT_EQ(run.events[0].t, 0.0);
  EXPECT_EQ(run.events[0].unique, false);
}

/// A run goes on from what another one has left of the speeds of fingers that hold a block: speeds of rounding
/// do not jam them.
TEST(ContactsWithOpenForces, FingersThatHoldABlockAreNotJammedByRoundings) {
  for (const double speed : {0.0, 5e-324, 1e-300, 1e-17}) {
    for (const double asymmetry : {1.0, 0.0, -1.0}) {
      SCOPED_TRACE(::testing::Message() << speed << " " << asymmetry);
      model::Builder model("gripper");
      const SX x = model.state("x", {0.0}), z = model.state("z", {0.5});
      const SX a = model.state("a", {-0.1}), b = model.state("b", {0.1});
      for (const auto& rate : rates) static_cast<void>(model.state(rate, {0.0}));
      static_cast<void>(model.state("va", {speed}));
      static_cast<void>(model.state("vb", {-asymmetry * speed}));
      model.mechanics({.positions = {"x", "z", "a", "b"},
                       .velocities = {"vx", "vz", "va", "vb"},
                       .mass = SX::diag(SX(std::vector<double>{0.62, 0.62, 0.4, 0.4})),
                       .force = {{"vz", -6.0}, {"va", 7.0}, {"vb", -7.0}}});
      model.contact("left", x - 0.1 - a, {.tangent = {{"z", 1.0}}, .friction = 0.7});
      model.contact("right", b - x - 0.1, {.tangent = {{"z", 1.0}}, .friction = 0.7});
      const auto run = run_tightly(model, 1.0);
      ASSERT_EQ(run.status.termination, result::Termination::completed) << run.status.message;
      EXPECT_NEAR(run.final.x[1], 0.5, 1e-12);
    }
  }
}

/// A load goes around on a table with four legs, of which three suffice.
TEST(ContactsWithOpenForces, ATableStandsOnAllItsLegs) {
  model::Builder model("table");
  const SX z = model.state("z", {0.0}), a = model.state("a", {0.0}), b = model.state("b", {0.0});
  for (const char* name : {"vz", "va", "vb"}) static_cast<void>(model.state(name, {0.0}));
  const SX t = model.time();
  model.mechanics({.positions = {"z", "a", "b"},
                   .velocities = {"vz", "va", "vb"},
                   .force = {{"vz", SX(-weight)}, {"va", -0.8 * weight * cos(t)}, {"vb", -0.8 * weight * sin(t)}}});
  int leg = 0;
  for (const double along : {-1.0, 1.0}) {
    for (const double across : {-1.0, 1.0}) model.contact("leg" + std::to_string(++leg), z + along * a + across * b);
  }
  const auto run = run_tightly(model, 4.0 * std::numbers::pi);
  ASSERT_EQ(run.status.termination, result::Termination::completed) << run.status.message;
  EXPECT_TRUE(run.events.empty());
  EXPECT_EQ(run.final.contact_modes, std::vector<ContactMode>(4, ContactMode::closed));
  for (const auto& outputs : run.trajectory.outputs) {
    double carried = 0.0;
    for (std::size_t k = 0; k < 4; ++k) {
      EXPECT_GE(outputs[3 * k + 1], -1e-9);
      carried += outputs[3 * k + 1];
    }
    EXPECT_NEAR(carried, weight, 1e-9);
  }
}

}  // namespace
/// Two blocks that rub on the ground with 1 and 3, pressed on each other: they brake with 4 together. A drive of 3 t/2
/// on the first one moves both once it is as large. Which part of it each friction bears is open until then.
TEST(ContactsWithOpenForces, BlocksThatPressOnEachOtherStopAndLeaveTogether) {
  model::Builder model("blocks");
  const SX x = model.state("x", {0.0}), y = model.state("y", {1.0});
  const SX vx = model.state("vx", {1.0}), vy = model.state("vy", {1.0});
  const SX sign_x = model.sign(vx), sign_y = model.sign(vy);
  model.mechanics({.positions = {"x", "y"},
                   .velocities = {"vx", "vy"},
                   .force = {{"vx", 1.5 * model.time() - sign_x}, {"vy", -3.0 * sign_y}}});
  model.contact("touch", y - x - 1.0, {});
  const auto run = run_tightly(model, 6.0);
  ASSERT_EQ(run.status.termination, result::Termination::completed) << run.status.message;
  ASSERT_EQ(run.events.size(), 2U);
  // 1 - 2 t + 3 t^2/8 = 0
  const double stop = (2.0 - std::sqrt(2.5)) / 0.75, leave = 8.0 / 3.0;
  EXPECT_NEAR(run.events[0].t, stop, 1e-9);
  EXPECT_EQ(*run.events[0].mode_after, (result::Mode{0, 0}));
  EXPECT_NEAR(run.events[1].t, leave, 1e-9);
  EXPECT_EQ(*run.events[1].mode_after, (result::Mode{1, 1}));
  for (const std::size_t v : {2U, 3U}) EXPECT_NEAR(run.final.x[v], 0.375 * (6.0 - leave) * (6.0 - leave), 1e-8);
}

/// A motor against its stop with the dry friction c sign(w), driven by 2 + i with di/dt = rate(i): what of the drive
/// friction bears at the stop is open, the motion is not.
Integration motor_at_stop(ode::Method method, double friction, const std::function<SX(const SX&)>& rate) {
  model::Builder model("motor");
  const SX a = model.state("a", {0.0}), w = model.state("w", {0.0}), i = model.state("i", {0.0});
  model.dynamics("i", rate(i));
  model.mechanics(
      {.positions = {"a"}, .velocities = {"w"}, .mass = {{0.3}}, .force = {{"w", 2.0 + i - friction * model.sign(w)}}});
  model.contact("stop", 0.5 - a, {});
  IntegrationOptions options;
  options.method = method;
  options.until = 4.0;
  return run_model(model, options);
}

constexpr auto methods_at_stop = {ode::Method::dopri5, ode::Method::dop853,  ode::Method::radau5,
                                  ode::Method::radau9, ode::Method::radau13, ode::Method::taylor};

TEST(ContactsWithOpenForces, AMotorPressedOnItsStopRestsThere) {
  for (const auto method : methods_at_stop) {
    SCOPED_TRACE(static_cast<int>(method));
    const auto run = motor_at_stop(method, 0.1, [](const SX& i) { return 1.5 - i; });
    ASSERT_EQ(run.status.termination, result::Termination::completed) << run.status.message;
    ASSERT_FALSE(run.events.empty());
    EXPECT_EQ(run.events.back().kind, EventKind::impact);
    EXPECT_NEAR(run.final.x[0], 0.5, 1e-12);
    EXPECT_NEAR(run.final.x[1], 0.0, 1e-15);
    EXPECT_NEAR(run.final.x[2], 1.5 * (1.0 - std::exp(-4.0)), 1e-7);
  }
}

/// It leaves once the drive pulls more than friction holds: 2 - 1.5 t = -c.
TEST(ContactsWithOpenForces, AMotorLeavesItsStopAgainstFriction) {
  for (const auto method : methods_at_stop) {
    SCOPED_TRACE(static_cast<int>(method));
    const auto run = motor_at_stop(method, 0.4, [](const SX&) { return SX(-1.5); });
    ASSERT_EQ(run.status.termination, result::Termination::completed) << run.status.message;
    ASSERT_FALSE(run.events.empty());
    const double leave = 2.4 / 1.5, left = 4.0 - leave;
    EXPECT_EQ(run.events.back().kind, EventKind::lift_off);
    EXPECT_NEAR(run.events.back().t, leave, 1e-8);
    EXPECT_EQ(*run.events.back().mode_after, result::Mode{-1});
    EXPECT_NEAR(run.final.x[0], 0.5 - 5.0 * left * left * left / 6.0, 1e-6);
    EXPECT_NEAR(run.final.x[1], -2.5 * left * left, 1e-6);
  }
}

/// A body that friction stops at a wall is pushed into it later: the wall holds it, whatever roundings of the gap the
/// impact has left.
TEST(ContactsWithOpenForces, AWallHoldsWhatFrictionHasHeldAtIt) {
  for (const auto method : {ode::Method::dopri5, ode::Method::radau13}) {
    for (int k = 0; k < 40; ++k) {
      const double wall = 0.1 + 0.01 * k;
      SCOPED_TRACE(::testing::Message() << static_cast<int>(method) << " " << wall);
      model::Builder model("body");
      const SX a = model.state("a", {0.0}), w = model.state("w", {3.0}), t = model.time();
      model.mechanics({.positions = {"a"},
                       .velocities = {"w"},
                       .mass = {{0.3}},
                       .force = {{"w", t * t - 0.05 - 0.4 * model.sign(w)}}});
      model.contact("wall", wall - a, {});
      IntegrationOptions options;
      options.method = method;
      options.until = 1.5;
      const auto run = run_model(model, options);
      ASSERT_EQ(run.status.termination, result::Termination::completed) << run.status.message;
      EXPECT_NEAR(run.final.x[0], wall, 1e-12);
      EXPECT_EQ(run.final.contact_modes, std::vector<ContactMode>{ContactMode::closed});
    }
  }
}

}  // namespace saltus::event_integrator::testing
