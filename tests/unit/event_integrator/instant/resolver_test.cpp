// From what is at zero at one time to the mode behind it, each without a run.
#include <limits>
#include <string>
#include <vector>

#include "instants.hpp"

namespace saltus::event_integrator::testing::single_instants {
namespace {

using casadi::SX;
using model::Builder;
using Signs = std::vector<int>;

constexpr double infinity = std::numeric_limits<double>::infinity();

/// x' = a + b sign(x): crossed where |a| > |b|, slid on where b < -|a|.
Builder relay(double a, double b, double start) {
  Builder model("relay");
  const SX x = model.state("x", {start});
  model.dynamics("x", a + b * model.sign(x));
  return model;
}

TEST(Resolver, ASurfaceIsCrossed) {
  Builder model = relay(2.0, 1.0, -1.0);
  Instants at(model);
  ASSERT_TRUE(at.resolver.start());
  EXPECT_EQ(at.mode(), Signs{-1});
  at.meet(1.0, {0.0}, {{FunctionKind::surface, 0}});
  EXPECT_EQ(at.mode(), Signs{1});
  EXPECT_EQ(at.run.here.slope, std::vector<double>{3.0});
  EXPECT_EQ(at.events(), 1);
  EXPECT_EQ(at.client.begun, 2);  // at the start, and behind it
  EXPECT_TRUE(at.resolver.outcome().switched);
  EXPECT_TRUE(at.resolver.outcome().by_one_surface);
}

TEST(Resolver, ASurfaceIsSlidOn) {
  Builder model = relay(0.5, -1.0, -1.0);
  Instants at(model);
  ASSERT_TRUE(at.resolver.start());
  at.meet(2.0 / 3.0, {0.0}, {{FunctionKind::surface, 0}});
  EXPECT_EQ(at.mode(), Signs{0});
  EXPECT_EQ(at.run.here.slope, std::vector<double>{0.0});
  EXPECT_NEAR(at.run.here.state.alpha[0], 0.75, 1e-15);
}

TEST(Resolver, TheSameModeAgainIsTheSameMode) {
  Builder model = relay(0.5, -1.0, -1.0);
  Instants at(model);
  ASSERT_TRUE(at.resolver.start());
  at.meet(2.0 / 3.0, {0.0}, {{FunctionKind::surface, 0}});
  const ModeState state = at.run.here.state;
  const auto x = at.x(), slope = at.run.here.slope;
  at.again();
  EXPECT_EQ(at.run.here.state.mode, state.mode);
  EXPECT_EQ(at.run.here.state.alpha, state.alpha);
  EXPECT_EQ(at.x(), x);
  EXPECT_EQ(at.run.here.slope, slope);
  EXPECT_EQ(at.events(), 1);
}

/// Where both fields lead away more than one motion follows, from the surface as a start.
TEST(Resolver, AStartThatIsLeftToBothSidesIsNotUnique) {
  Builder model = relay(0.0, 1.0, 0.0);
  Instants at(model);
  ASSERT_TRUE(at.resolver.start());
  EXPECT_EQ(at.client.chosen, 1);
  EXPECT_NE(at.resolver.outcome().transition.unique, true);
  EXPECT_EQ(at.events(), 1);
}

/// x falls from 1 with the jump that adds 1 at x = 0.
Builder falling(const SX& behind_factor) {
  Builder model("falling");
  const SX x = model.state("x", {1.0});
  model.dynamics("x", -1.0);
  model.jump(x, model::Direction::down, {{"x", behind_factor + x}}, {.name = "lift"});
  return model;
}

TEST(Resolver, AJumpIsExecutedAndItsGuardGoesOnFromThere) {
  Builder model = falling(1.0);
  Instants at(model);
  ASSERT_TRUE(at.resolver.start());
  at.meet(1.0, {0.0}, {{FunctionKind::user, 0}});
  EXPECT_EQ(at.x(), std::vector<double>{1.0});
  EXPECT_TRUE(at.resolver.outcome().jumped);
  EXPECT_EQ(at.run.ledger.signs(), Signs{1});
  EXPECT_EQ(at.events(), 1);
}

/// A jump that changes nothing where the motion leads on through its guard would be executed for ever.
TEST(Resolver, AJumpToItsOwnLimitEndsTheRunWithItsName) {
  Builder model("clamp");
  const SX x = model.state("x", {1.0});
  model.dynamics("x", -1.0);
  model.jump(model::less(x, 0.0), {{"x", 0.0}}, {.name = "clamp"});
  Instants at(model);
  ASSERT_TRUE(at.resolver.start());
  at.meet(1.0, {0.0}, {{FunctionKind::user, 0}});
  EXPECT_FALSE(at.run.running);
  EXPECT_EQ(at.run.status.termination, result::Termination::outside_class);
  EXPECT_NE(at.run.status.message.find("'clamp'"), std::string::npos) << at.run.status.message;
}

TEST(Resolver, AStopLetsTheJumpOfItsTimeHappen) {
  Builder model = falling(1.0);
  const SX x = model.state("y", {1.0});
  model.dynamics("y", -1.0);
  model.event(x, {.name = "down", .action = model::AtEvent::stop});
  Instants at(model);
  ASSERT_TRUE(at.resolver.start());
  at.meet(1.0, {0.0, 0.0}, {{FunctionKind::user, 0}, {FunctionKind::user, 1}});
  EXPECT_FALSE(at.run.running);
  EXPECT_EQ(at.run.status.termination, result::Termination::stopped_by_event);
  EXPECT_EQ(at.x(), (std::vector<double>{1.0, 0.0}));
}

/// Jumps that trigger each other at one time end with their names.
TEST(Resolver, EndlessJumpsAreStoppedAndNamed) {
  Builder model("ping-pong");
  const SX x = model.state("x", {1.0});
  const SX n = model.discrete_state("n", 0.0);
  model.dynamics("x", -1.0);
  model.jump(model::less(x, 0.5) && model::less(n, 0.5), {{"n", 1.0}}, {.name = "ping"});
  model.jump(model::greater(n, 0.5), {{"n", 0.0}}, {.name = "pong"});
  Instants at(model);
  ASSERT_TRUE(at.resolver.start());
  at.meet(0.5, {0.5, 0.0}, {{FunctionKind::user, 0}});
  EXPECT_EQ(at.run.status.termination, result::Termination::iteration_limit);
  EXPECT_NE(at.run.status.message.find("'ping'"), std::string::npos) << at.run.status.message;
}

/// A ball: restitution 0.5 turns -2 into 1; restitution 0 closes the gap, and gravity holds it closed.
Builder ball(double restitution, double velocity) {
  Builder model("ball");
  const SX z = model.state("z", {1.0});
  static_cast<void>(model.state("v", {velocity}));
  model.mechanics({.positions = {"z"}, .velocities = {"v"}, .force = {{"v", -1.0}}});
  model.contact("ground", z, {.restitution = restitution});
  return model;
}

TEST(Resolver, ABodyBounces) {
  Builder model = ball(0.5, -1.5);
  Instants at(model);
  ASSERT_TRUE(at.resolver.start());
  const auto n = at.x().size();
  auto x = at.x();
  x[0] = 0.0;
  x[1] = -2.0;
  at.meet(0.5, x, {{FunctionKind::user, 0}});
  ASSERT_EQ(at.x().size(), n);
  EXPECT_EQ(at.x()[0], 0.0);
  EXPECT_DOUBLE_EQ(at.x()[1], 1.0);
  EXPECT_EQ(at.events(), 1);
}

TEST(Resolver, ABodyComesToRest) {
  Builder model = ball(0.0, -1.5);
  Instants at(model);
  ASSERT_TRUE(at.resolver.start());
  auto x = at.x();
  x[0] = 0.0;
  x[1] = -2.0;
  at.meet(0.5, x, {{FunctionKind::user, 0}});
  EXPECT_EQ(at.x()[0], 0.0);
  EXPECT_EQ(at.x()[1], 0.0);
  EXPECT_EQ(at.run.here.slope[1], 0.0);  // the ground carries it
  EXPECT_TRUE(at.run.contacts.hold());
}

/// A field that is undefined behind its switch ends the run with the state.
TEST(Resolver, AFieldThatIsNotFiniteEndsTheRun) {
  Builder model("log");
  const SX x = model.state("x", {-1.0});
  const SX y = model.state("y", {1.0});
  model.dynamics("x", 1.0);
  model.dynamics("y", model.if_(model::greater(x, 0.0), 1.0 / (y - y), 0.0));
  Instants at(model);
  ASSERT_TRUE(at.resolver.start());
  at.meet(1.0, {0.0, 1.0}, {{FunctionKind::surface, 0}});
  const bool ended = !at.run.running || !at.client.undecided.empty();
  EXPECT_TRUE(ended);
}

/// The limit of switches begins the mode that it is given, and is an event.
TEST(Resolver, TheLimitOfSwitchesIsAnEvent) {
  Builder model = relay(0.5, -1.0, -1.0);
  Instants at(model);
  ASSERT_TRUE(at.resolver.start());
  Instant instant{.cause = Instant::Cause::limit_of_switches};
  instant.limit.t = 1.0;
  instant.x = {0.0};
  instant.surfaces = {0};
  instant.transition.state = at.run.here.state;
  set_surface(instant.transition.state, 0, 0, 0.75);
  set_corner_alpha(instant.transition.state);
  instant.transition.zero_order = {0};
  EXPECT_TRUE(at.resolver.resolve(instant));
  EXPECT_EQ(at.mode(), Signs{0});
  EXPECT_EQ(at.run.here.t, 1.0);
  EXPECT_EQ(at.events(), 1);
  EXPECT_EQ(at.run.last_event, 1.0);
}

/// Where nothing is due at a time of jumps nothing has happened.
TEST(Resolver, NothingDueIsNothing) {
  Builder model = falling(1.0);
  Instants at(model);
  ASSERT_TRUE(at.resolver.start());
  EXPECT_FALSE(at.resolver.resolve(Instant{.cause = Instant::Cause::due}));
  EXPECT_EQ(at.events(), 0);
  EXPECT_EQ(at.run.jumps.next_time(), infinity);
}

}  // namespace
}  // namespace saltus::event_integrator::testing::single_instants
