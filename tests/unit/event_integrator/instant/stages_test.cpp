// The stages of an instant, each alone.
#include <vector>

#include "instants.hpp"
#include "saltus/event_integrator/instant/cell_stage.hpp"
#include "saltus/event_integrator/instant/contact_stage.hpp"
#include "saltus/event_integrator/instant/instant_rows.hpp"
#include "saltus/event_integrator/instant/jump_stage.hpp"
#include "saltus/event_integrator/instant/limit_stage.hpp"
#include "saltus/event_integrator/instant/mass_beyond.hpp"
#include "saltus/event_integrator/instant/rest_stage.hpp"
#include "saltus/event_integrator/instant/switch_stage.hpp"
#include "saltus/event_integrator/instant/user_signs.hpp"

namespace saltus::event_integrator::testing::stages {
namespace {

using casadi::SX;
using model::Builder;

/// x' = -1 from 1; at x = 0 a jump sets it to 1 and counts.
Builder counter() {
  Builder model("counter");
  const SX x = model.state("x", {1.0});
  const SX n = model.discrete_state("n", 0.0);
  model.dynamics("x", -1.0);
  model.jump(x, model::Direction::down, {{"x", 1.0 + x}, {"n", n + 1.0}}, {.name = "lift"});
  model.event(x - 0.5, {.name = "half"});
  return model;
}

/// A block on the ground under a force f, at z with velocity v.
Builder block(double z, double v, double f) {
  Builder model("block");
  const SX height = model.state("z", {z});
  static_cast<void>(model.state("v", {v}));
  model.mechanics({.positions = {"z"}, .velocities = {"v"}, .force = {{"v", f - 1.0}}});
  model.contact("ground", height, {.restitution = 0.5});
  return model;
}

TEST(UserSigns, AFunctionThatWasLocatedGoesOnWithTheOtherSign) {
  Builder model = counter();
  Instants at(model);
  ASSERT_TRUE(at.resolver.start());
  const Located half = at.located(0.5, {0.5, 0.0}, {{FunctionKind::user, 0}});  // events come first
  ASSERT_EQ(half.functions.size(), 1U);
  ASSERT_EQ(at.run.ledger.signs()[0], 1);
  at.run.here.move_to(half.t, half.x.data());
  flip_user_functions(at.context(), half);
  EXPECT_EQ(at.run.ledger.signs()[0], -1);
  EXPECT_EQ(fire_user_events(at.context(), half.x, at.run.here.state), std::vector<std::size_t>{0});
  EXPECT_EQ(at.events(), 1);
  EXPECT_TRUE(fire_user_events(at.context(), half.x, at.run.here.state).empty());  // once
}

TEST(JumpStage, AnExecutionMovesTheStateAndItsGuard) {
  Builder model = counter();
  Instants at(model);
  ASSERT_TRUE(at.resolver.start());
  EXPECT_EQ(jump_names(at.run.switching.layout, {0}), "'lift'");
  const Located zero = at.located(1.0, {0.0, 0.0}, {{FunctionKind::user, 1}});
  at.run.here.move_to(zero.t, zero.x.data());
  const auto context = at.context();
  flip_user_functions(context, zero);
  context.cascade.begin(zero);
  ASSERT_TRUE(update_jumps(context));
  ASSERT_TRUE(at.run.jumps.due(1.0));
  ASSERT_TRUE(execute_due_jumps(context));
  EXPECT_EQ(at.x(), (std::vector<double>{1.0, 1.0}));
  EXPECT_FALSE(at.run.jumps.due(1.0));
  EXPECT_EQ(context.cascade.executed().size(), 1U);
  EXPECT_TRUE(decide_behind_jumps(context));
  EXPECT_TRUE(check_behind_jumps(context));
}

TEST(ContactStage, BodiesThatApproachCollideWhereContactsBegin) {
  Builder model = block(0.0, -2.0, 0.0);
  Instants at(model);
  const auto context = at.context();
  ASSERT_TRUE(begin_contacts(context));
  EXPECT_EQ(at.x()[1], 1.0);  // restitution 0.5
  ASSERT_EQ(context.cascade.executed().size(), 1U);
  EXPECT_EQ(context.cascade.executed().back().x[1], -2.0);
  EXPECT_FALSE(only_slips_on(context));
}

TEST(ContactStage, AGapThatJumpsBeginsContactsAnew) {
  Builder model = block(0.0, 0.0, 0.0);
  Instants at(model);
  ASSERT_TRUE(at.resolver.start());
  EXPECT_FALSE(contacts_jump(at.context()));
  at.run.here.x[0] = 1.0;
  EXPECT_TRUE(contacts_jump(at.context()));
  EXPECT_FALSE(at.run.contacts.hold());
}

TEST(RestStage, ContactsWithoutFrictionKeepNoSurfaceAtZero) {
  Builder model = block(0.0, 0.0, 0.0);
  Instants at(model);
  ASSERT_TRUE(at.resolver.start());
  RestingSurfaces resting;
  EXPECT_TRUE(find_resting(at.context(), resting));
  EXPECT_TRUE(resting.surfaces.empty());
  EXPECT_FALSE(hold_resting(at.context()));
  EXPECT_FALSE(release(at.context(), at.located(0.0, at.x(), {})));
}

/// x' = floor(t) has ends of cells at t = 1, 2, …
TEST(CellStage, AnEndOfACellIsLeftWithAJump) {
  Builder model("stairs");
  static_cast<void>(model.state("x", {0.0}));
  model.dynamics("x", model.floor(model.time()));
  Instants at(model);
  ASSERT_TRUE(at.resolver.start());
  EXPECT_EQ(at.run.here.slope[0], 0.0);
  Located end{1.0, {0.0}, {}, {}};
  for (std::size_t place = 0; place < at.run.search.functions().size(); ++place) {
    if (at.run.search.functions()[place].kind != FunctionKind::cell_upper) continue;
    end.functions.push_back(place);
    end.signs.push_back(at.run.search.functions()[place].sign);
  }
  ASSERT_TRUE(reaches_cell_end(at.run.search, end));
  at.run.here.move_to(end.t, end.x.data());
  EXPECT_FALSE(breaks_here(at.run).functions.empty());
  EXPECT_EQ(leave_cells(at.context(), end), CellChange::jump);
  EXPECT_FALSE(find_undefined_cells(at.run));
  at.again();
  EXPECT_EQ(at.run.here.slope[0], 1.0);
}

TEST(SwitchStage, WhatIsLocatedIsTouchedAndDecided) {
  Builder model("relay");
  const SX x = model.state("x", {-1.0});
  model.dynamics("x", 0.5 - model.sign(x));
  Instants at(model);
  ASSERT_TRUE(at.resolver.start());
  const Located zero = at.located(1.0, {0.0}, {{FunctionKind::surface, 0}});
  at.run.here.move_to(zero.t, zero.x.data());
  const auto context = at.context();
  arrive(context, false);
  ASSERT_TRUE(collect_surfaces(context, zero, 0.0));
  EXPECT_EQ(context.out.switching_point.touched, std::vector<int>{0});
  EXPECT_EQ(context.out.switching_point.at_zero, std::vector<int>{0});
  const ModeState& from = touch_others(context);
  EXPECT_EQ(&from, &context.out.before);
  decide_touched(context, from, at.resolver.single(), at.resolver.pair());
  EXPECT_EQ(context.out.transition.state.mode, std::vector<int>{0});
  EXPECT_EQ(at.mode(), std::vector<int>{-1});  // nothing is entered
}

// What is slid on steps away in time: its new sign is read, as after a jump.
TEST(CellStage, WhatTimeMovesIsDecidedAsAfterAJump) {
  Builder model("stepped");
  const SX x = model.state("x", {0.0});
  const SX reference = model.step(model.time() - 1.0);
  model.dynamics("x", 0.5 - model.sign(x - reference));
  Instants at(model);
  ASSERT_TRUE(at.resolver.start());
  ASSERT_EQ(at.mode(), (std::vector<int>{-1, 0}));
  const Located step = at.located(1.0, {0.0}, {{FunctionKind::surface, 0}});
  at.run.here.move_to(step.t, step.x.data());
  const auto context = at.context();
  arrive(context, false);
  ASSERT_TRUE(collect_surfaces(context, step, 0.0));
  EXPECT_FALSE(time_moves_surfaces(context));  // it is held to the first order only
  ASSERT_TRUE(decide_behind_times(context));
  EXPECT_EQ(context.out.transition.state.mode, (std::vector<int>{1, -1}));
}

TEST(InstantRows, AnInstantHasARowBeforeItAndBehindIt) {
  Builder model = counter();
  Instants at(model);
  ASSERT_TRUE(at.resolver.start());
  const auto rows = at.run.recorder.rows();
  at.meet(1.0, {0.0, 0.0}, {{FunctionKind::user, 1}});
  EXPECT_EQ(at.run.recorder.rows(), rows + 2);
  pass_to(at.run, 2.0, {0.5, 1.0});
  EXPECT_EQ(at.run.here.t, 2.0);
  EXPECT_EQ(at.x(), (std::vector<double>{0.5, 1.0}));
}

/// Jumps whose guards are not at 0 at their limit say nothing of what follows.
TEST(LimitStage, JumpsWithoutAGuardAtZeroHaveNoMotionBehindTheirLimit) {
  Builder model = counter();
  Instants at(model);
  ASSERT_TRUE(at.resolver.start());
  Instant limit{.cause = Instant::Cause::limit_of_jumps};
  limit.limit.events = {0};
  EXPECT_FALSE(rest_at_limit(at.context(), limit));
  EXPECT_NE(at.run.status.message.find("'lift'"), std::string::npos) << at.run.status.message;
}

TEST(MassBeyond, APositiveMassIsPositiveBeyond) {
  Builder model = block(1.0, 0.0, 0.0);
  Instants at(model);
  ASSERT_TRUE(at.resolver.start());
  EXPECT_FALSE(indefinite_mass_beyond(at.run).has_value());
}

TEST(MassBeyond, AMassThatVanishesIsNamed) {
  Builder model("mass");
  const SX q = model.state("q", {1.0});
  static_cast<void>(model.state("v", {-1.0}));
  model.mechanics({.positions = {"q"}, .velocities = {"v"}, .mass = q, .force = {{"v", 0.0}}});
  Instants at(model);
  ASSERT_TRUE(at.resolver.start());
  at.run.here.t = 1.0;
  at.run.here.x = {1e-14, -1.0};
  at.run.here.slope = {-1.0, 0.0};
  const auto message = indefinite_mass_beyond(at.run);
  ASSERT_TRUE(message.has_value());
  EXPECT_NE(message->find("not positive definite"), std::string::npos) << *message;
}

}  // namespace
}  // namespace saltus::event_integrator::testing::stages
