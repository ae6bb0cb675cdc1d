// Contacts whose forces the motion does not determine, and motions that it leaves open with them.
#include <algorithm>
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

/// Two stops without clearance: of both the one carries that the force will press on, at the start, where it is 0, too.
TEST(ContactsWithOpenForces, StopsWithoutClearanceCarryInTurn) {
  for (const double sign : {1.0, -1.0}) {
    SCOPED_TRACE(sign);
    model::Builder model("body");
    const SX x = model.state("x", {0.0});
    static_cast<void>(model.state("v", {0.0}));
    model.mechanics({.positions = {"x"}, .velocities = {"v"}, .force = {{"v", sign * sin(model.time())}}});
    model.contact("lower", x, {});
    model.contact("upper", -x, {});
    const auto run = run_tightly(model, 8.0);
    ASSERT_EQ(run.status.termination, result::Termination::completed) << run.status.message;
    EXPECT_LE(run.events.size(), 2U);
    EXPECT_EQ(run.final.x[0], 0.0);
    EXPECT_EQ(run.final.x[1], 0.0);
    for (std::size_t row = 0; row < run.trajectory.t.size(); ++row) {
      const auto& outputs = run.trajectory.outputs[row];  // gap, force and impulse of both, then the energy
      const double force = sign * std::sin(run.trajectory.t[row]);
      EXPECT_NEAR(outputs[1], std::max(0.0, -force), 1e-9) << run.trajectory.t[row];
      EXPECT_NEAR(outputs[4], std::max(0.0, force), 1e-9) << run.trajectory.t[row];
    }
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

namespace {

/// A rod falls flat on its two ends, at a distance of 1 from its centre; its mass is 1.
Integration rod_on_its_ends(double inertia, double restitution) {
  model::Builder model("rod");
  const SX z = model.state("z", {0.0}), a = model.state("a", {0.0});
  static_cast<void>(model.state("vz", {-1.0}));
  static_cast<void>(model.state("w", {0.0}));
  SX mass = SX::eye(2);
  mass(1, 1) = inertia;
  model.mechanics({.positions = {"z", "a"}, .velocities = {"vz", "w"}, .mass = mass});
  model.contact("left", z - sin(a), {.restitution = restitution});
  model.contact("right", z + sin(a), {.restitution = restitution});
  return run_tightly(model, 0.1);
}

/// What an end does to the other one is c = (J - 1)/(J + 1) of what is done to it.
TEST(OrdersOfImpacts, ARodLandsFlatInEveryOrderIfItsEndsPressEachOtherDown) {
  for (const auto& [inertia, restitution] : {std::pair{1.0 / 3.0, 0.0}, std::pair{0.9, 0.0}, std::pair{1.0, 0.5}}) {
    const auto run = rod_on_its_ends(inertia, restitution);
    ASSERT_EQ(run.events.size(), 1U);
    EXPECT_EQ(run.events[0].unique, true) << inertia << ": " << run.events[0].reason;
    EXPECT_NEAR(run.events[0].x_after[2], restitution, 1e-14);
  }
}

TEST(OrdersOfImpacts, ARodLandsFlatOrTipsIfItsEndsLiftEachOther) {
  // J = 3, c = 1/2: behind the first impact the other end falls with 1 - c, and lifts the first one by (1 - c) c.
  const auto tips = rod_on_its_ends(3.0, 0.0);
  ASSERT_EQ(tips.events.size(), 1U);
  EXPECT_EQ(tips.events[0].unique, false);
  EXPECT_NEAR(tips.events[0].x_after[2], 0.0, 1e-14);
  const std::string other =
      "one behind the other ('left', 'right') they would end elsewhere: the rate of the gap of 'left' is 0.25, not 0";
  EXPECT_NE(tips.events[0].reason.find(other), std::string::npos) << tips.events[0].reason;
  // With restitution the ends of a thin one, c = -1/2, end apart as well.
  const auto bounces = rod_on_its_ends(1.0 / 3.0, 0.5);
  ASSERT_EQ(bounces.events.size(), 1U);
  EXPECT_EQ(bounces.events[0].unique, false);
}

/// The first event of three equal balls in a row that touch.
result::Event balls_in_a_row(const std::vector<double>& speed, double restitution) {
  model::Builder model("cradle");
  std::vector<SX> q;
  for (std::size_t i = 0; i < 3; ++i) q.push_back(model.state("q" + std::to_string(i), {static_cast<double>(i)}));
  for (std::size_t i = 0; i < 3; ++i) static_cast<void>(model.state("v" + std::to_string(i), {speed[i]}));
  model.mechanics({.positions = {"q0", "q1", "q2"}, .velocities = {"v0", "v1", "v2"}});
  model.contact("first", q[1] - q[0] - 1.0, {.restitution = restitution});
  model.contact("second", q[2] - q[1] - 1.0, {.restitution = restitution});
  return run_tightly(model, 0.1).events[0];
}

/// One behind the other the last ball of a cradle takes all of the velocity. From both sides elastic balls exchange
/// theirs in either order, and balls without restitution stop.
TEST(OrdersOfImpacts, BallsInARow) {
  const auto cradle = balls_in_a_row({1.0, 0.0, 0.0}, 1.0);
  EXPECT_EQ(cradle.unique, false);
  EXPECT_NE(cradle.reason.find("('first', 'second')"), std::string::npos) << cradle.reason;
  for (const double restitution : {0.0, 1.0}) {
    const auto both = balls_in_a_row({1.0, 0.0, -1.0}, restitution);
    EXPECT_EQ(both.unique, true) << both.reason;
  }
  EXPECT_EQ(balls_in_a_row({1.0, 0.0, 0.0}, 0.0).unique, true);
  EXPECT_EQ(balls_in_a_row({1.0, 0.0, -1.0}, 0.5).unique, false);
}

/// A point mass flies into a corner. Impacts of two walls at right angles know nothing of each other; friction that
/// ends all of the motion does so in every order, other friction does not.
TEST(OrdersOfImpacts, ACorner) {
  const auto into_corner = [](double friction, double restitution) {
    model::Builder model("corner");
    const SX x = model.state("x", {0.0}), z = model.state("z", {0.0});
    static_cast<void>(model.state("vx", {-1.0}));
    static_cast<void>(model.state("vz", {-0.5}));
    model.mechanics({.positions = in_plane, .velocities = rates});
    const auto options = [&](const char* along) {
      model::ContactOptions result;
      result.restitution = restitution;
      result.friction = friction;
      if (friction > 0.0) result.tangent = {{along, 1.0}};
      return result;
    };
    model.contact("wall", x, options("z"));
    model.contact("ground", z, options("x"));
    return run_tightly(model, 0.1).events[0];
  };
  EXPECT_EQ(into_corner(0.0, 0.0).unique, true);
  EXPECT_EQ(into_corner(0.0, 0.7).unique, true);
  EXPECT_EQ(into_corner(0.3, 0.0).unique, true);
  EXPECT_EQ(into_corner(0.3, 0.7).unique, false);
}

/// Ends of a rod lean on each other, ever less in turn, and friction holds them: the limit is rest.
TEST(OrdersOfImpacts, FrictionHoldsWhatLandsInEveryOrder) {
  model::Builder model("rod");
  static_cast<void>(model.state("x", {0.0}));
  const SX z = model.state("z", {0.0}), a = model.state("a", {0.0});
  static_cast<void>(model.state("vx", {0.01}));
  static_cast<void>(model.state("vz", {-1.0}));
  static_cast<void>(model.state("w", {0.1}));
  SX mass = SX::eye(3);
  mass(2, 2) = 1.0 / 3.0;
  model.mechanics(
      {.positions = {"x", "z", "a"}, .velocities = {"vx", "vz", "w"}, .mass = mass, .potential = weight * z});
  model.contact("left", z - sin(a), {.tangent = {{"x", 1.0}}, .friction = 0.5});
  model.contact("right", z + sin(a), {.tangent = {{"x", 1.0}}, .friction = 0.5});
  const auto run = run_tightly(model, 0.1);
  ASSERT_FALSE(run.events.empty());
  EXPECT_EQ(run.events[0].kind, EventKind::impact);
  EXPECT_EQ(run.events[0].unique, true) << run.events[0].reason;
  for (const std::size_t state : {3U, 4U, 5U}) EXPECT_NEAR(run.final.x[state], 0.0, 1e-14);
}

}  // namespace

namespace {

const Foot rear{"rear", -0.25, 0.3}, front{"front", 0.25, 2.0};

/// A box of height 2 h that slides on its feet.
Integration slide(const std::vector<Foot>& feet, double speed, double inertia) {
  model::Builder model("box");
  constexpr double h = 0.6;
  static_cast<void>(model.state("x", {0.0}));
  const SX z = model.state("z", {h}), a = model.state("a", {0.0});
  static_cast<void>(model.state("vx", {speed}));
  for (const char* name : {"vz", "w"}) static_cast<void>(model.state(name, {0.0}));
  model.mechanics({.positions = {"x", "z", "a"},
                   .velocities = {"vx", "vz", "w"},
                   .mass = SX::diag(SX(std::vector<double>{1.0, 1.0, inertia})),
                   .force = {{"vz", -10.0}}});
  for (const auto& [name, side, friction] : feet) {
    model.contact(name, z + side * sin(a) - h * cos(a),
                  {.tangent = {{"x", 1.0}, {"a", -side * sin(a) + h * cos(a)}}, .friction = friction});
  }
  return run_tightly(model, 0.1);
}

/// The front foot is the paradox: n'M^-1(n - mu t) < 0. Its impulse ends the slip at p = 2/4.85, and sticks then.
TEST(ContactsWithoutCollision, TheFootWhoseOwnFrictionPressesItOnIsHit) {
  for (const auto& feet : {std::vector{rear, front}, std::vector{front, rear}}) {
    const auto run = slide(feet, 2.0, 0.2);
    ASSERT_EQ(run.status.termination, result::Termination::completed) << run.status.message;
    ASSERT_FALSE(run.events.empty());
    const result::Event event = run.events[0];
    EXPECT_EQ(event.kind, EventKind::impact);
    EXPECT_EQ(event.surfaces, std::vector<std::string>{"front"});
    EXPECT_NEAR(event.x_after[3], 1.1566265060240963, 1e-9);
    EXPECT_NEAR(event.x_after[4], 0.4819277108433735, 1e-9);
    EXPECT_NEAR(event.x_after[5], -1.927710843373494, 1e-9);
  }
}

/// A disc in the corner of a rough ground and a rough wall: four rows in three positions.
TEST(ContactsWithDependentRows, ADiscInACornerStaysThere) {
  for (const double friction : {0.3, 0.9, 1.0, 1.51, 2.5}) {
    SCOPED_TRACE(friction);
    model::Builder model("disc");
    constexpr double radius = 0.24;
    const SX x = model.state("x", {0.0}), z = model.state("z", {0.0});
    static_cast<void>(model.state("a", {0.0}));
    for (const char* name : {"vx", "vz", "w"}) static_cast<void>(model.state(name, {0.0}));
    model.mechanics({.positions = {"x", "z", "a"},
                     .velocities = {"vx", "vz", "w"},
                     .mass = SX::diag(SX(std::vector<double>{2.47, 2.47, 0.0239})),
                     .force = {{"vz", -9.81 * 2.47}}});
    model.contact("ground", z, {.tangent = {{"x", 1.0}, {"a", radius}}, .friction = 0.43});
    model.contact("wall", x, {.tangent = {{"z", 1.0}, {"a", -radius}}, .friction = friction});
    const auto run = run_tightly(model, 1.0);
    ASSERT_EQ(run.status.termination, result::Termination::completed) << run.status.message;
    EXPECT_TRUE(run.events.empty());
    for (const double state : run.final.x) EXPECT_NEAR(state, 0.0, 1e-14);
    EXPECT_NEAR(run.trajectory.outputs.back()[1], 9.81 * 2.47, 1e-8);
  }
}

/// Two boxes of mass 1 on each other, friction 0.5 below, 0.4 between; 3 t pulls the lower one. How the corners share
/// friction is open: what comes to an edge is the share, and nothing slips before all do.
TEST(ContactsWithDependentRows, AStackSlipsOnceNoForcesHoldIt) {
  constexpr double half = 0.25, h = 0.05, fall = 9.81;
  for (const double until : {4.0, 5.0, 6.5}) {
    SCOPED_TRACE(until);
    model::Builder model("stack");
    std::vector<SX> q;
    const std::vector<std::string> names{"x1", "x2", "z1", "z2", "q1", "q2"},
        speeds{"u1", "u2", "v1", "v2", "w1", "w2"};
    for (const auto& name : names) q.push_back(model.state(name, {name == "z1" ? h : name == "z2" ? 3.0 * h : 0.0}));
    for (const auto& name : speeds) static_cast<void>(model.state(name, {0.0}));
    constexpr double inertia = 0.065 / 3.0;
    model.mechanics({.positions = names,
                     .velocities = speeds,
                     .mass = SX::diag(SX(std::vector<double>{1.0, 1.0, 1.0, 1.0, inertia, inertia})),
                     .force = {{"v1", -fall}, {"v2", -fall}, {"u1", 3.0 * model.time()}}});
    for (const double side : {-half, half}) {
      const std::string suffix = side < 0.0 ? "l" : "r";
      const SX down = side * sin(q[4]) - h * cos(q[4]);
      model.contact("below_" + suffix, q[2] + down, {.tangent = {{"x1", 1.0}, {"q1", -down}}, .friction = 0.5});
      const SX x = q[1] + side * cos(q[5]) + h * sin(q[5]) - q[0], z = q[3] + side * sin(q[5]) - h * cos(q[5]) - q[2];
      const SX along = cos(q[4]), up = sin(q[4]);
      const SX turn = -along * (side * sin(q[5]) - h * cos(q[5])) + up * (side * cos(q[5]) + h * sin(q[5]));
      model.contact(
          "between_" + suffix, along * z - up * x - h,
          {.tangent =
               {{"x2", along}, {"z2", up}, {"x1", -along}, {"z1", -up}, {"q2", turn}, {"q1", along * z - up * x}},
           .friction = 0.4});
    }
    const auto run = run_model(model, until, {1e-8, 1e-10});
    ASSERT_EQ(run.status.termination, result::Termination::completed) << run.status.message;
    ASSERT_EQ(run.events.size(), until < 5.5 ? 1U : 2U);
    EXPECT_EQ(run.events[0].kind, EventKind::slip);
    EXPECT_NEAR(run.events[0].t, fall / 3.0, 1e-7);
    EXPECT_EQ(run.events[0].surfaces, (std::vector<std::string>{"below_l", "below_r"}));
    EXPECT_NEAR(run.events.back().t, until < 5.5 ? fall / 3.0 : 0.6 * fall, 1e-7);
  }
}

}  // namespace
}  // namespace saltus::event_integrator::testing
