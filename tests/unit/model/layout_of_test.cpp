// What of a system is no expression.
#include "saltus/model/layout_of.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include "built_system.hpp"
#include "model_text.hpp"
#include "saltus/model/builder.hpp"

namespace saltus::model {
namespace {

using casadi::SX;

Layout::Jump jump_named(const Layout& layout, const std::string& name) {
  const auto found =
      std::find_if(layout.jumps.begin(), layout.jumps.end(), [&](const auto& jump) { return jump.name == name; });
  EXPECT_TRUE(found != layout.jumps.end()) << name;
  return found != layout.jumps.end() ? *found : Layout::Jump{};
}

TEST(LayoutOf, SurfacesColumnsAndEvents) {
  Builder model("relay");
  const SX k = model.parameter("k", 2.0);
  const SX x = model.state("x", {1.0}), on = model.discrete_state("on", 0.0);
  const SX slip = model.switching("slip", x - 0.2);
  model.dynamics("x", -model.sign(slip) + model.abs(x - k) + model.step(on - 0.5));
  model.output("twice", 2 * x);
  model.jump(greater(x, SX(3)), {{"on", 1 - on}}, {.name = "toggle"});
  model.event(x, {.name = "zero", .direction = Direction::up});
  model.event(greater_equal(x, SX(1)) && less(x, SX(4)), {.action = AtEvent::stop});
  const Layout layout = layout_of(finished(model));
  EXPECT_EQ(layout.name, "relay");
  EXPECT_EQ(layout.state_names, (Names{"x", "on"}));
  EXPECT_EQ(layout.parameter_names, Names{"k"});
  EXPECT_EQ(layout.output_names, Names{"twice"});
  EXPECT_EQ(layout.discrete_states, (std::vector<bool>{false, true}));
  const auto slips = std::find_if(layout.columns.begin(), layout.columns.end(),
                                  [](const auto& column) { return column.name == "slip"; });
  ASSERT_TRUE(slips != layout.columns.end());
  const auto& listed = layout.surfaces[static_cast<std::size_t>(slips->function)];
  EXPECT_EQ(listed.name, "slip");
  EXPECT_EQ(listed.role, SwitchingRole::listed);
  EXPECT_FALSE(listed.is_kink);
  const auto count = [&](SwitchingRole role) {
    return std::count_if(layout.surfaces.begin(), layout.surfaces.end(),
                         [&](const auto& surface) { return surface.role == role; });
  };
  EXPECT_EQ(count(SwitchingRole::kink), 1);
  EXPECT_EQ(count(SwitchingRole::discrete), 1);
  ASSERT_EQ(layout.events.size(), 2U);
  EXPECT_EQ(layout.events[0].name, "zero");
  EXPECT_EQ(layout.events[0].direction, Direction::up);
  EXPECT_FALSE(layout.events[0].is_condition());
  ASSERT_EQ(layout.events[1].guards.size(), 2U);
  EXPECT_NE(layout.events[1].guards[0].true_at_equality, layout.events[1].guards[1].true_at_equality);
  EXPECT_EQ(layout.events[1].action, AtEvent::stop);
  EXPECT_TRUE(layout.affine_in_selections);
}

TEST(LayoutOf, JumpsAndTables) {
  Builder model("clocked");
  const SX x = model.state("x", {1.0}), n = model.state("n", {0.0});
  const auto road = model.table("road", {0, 1, 2}, {0, 0.1, 0});
  model.dynamics("x", road(x) - model.floor(model.time()));
  model.dynamics("n", SX(0));
  model.jump(x, Direction::down, {{"x", -x}, {"n", n + 1}}, {.name = "bounce", .persistent = false});
  model.jump_at({0.5, 2.0}, {{"x", x + 1}}, {.name = "kick", .values = JumpValues::at_execution});
  model.jump_every(0.25, {{"n", SX(0)}}, {.name = "tick"});
  const System system = finished(model);
  const Layout layout = layout_of(system);
  EXPECT_EQ(layout.cell_names.size(), system.cells.size());
  EXPECT_GE(layout.cell_names.size(), 2U);
  const auto bounce = jump_named(layout, "bounce");
  EXPECT_EQ(bounce.trigger, JumpTrigger::guard_down);
  EXPECT_EQ(bounce.guards.size(), 1U);
  EXPECT_EQ(bounce.targets, (std::vector<int>{1, 0}));  // by name
  EXPECT_FALSE(bounce.persistent);
  const auto kick = jump_named(layout, "kick");
  EXPECT_EQ(kick.trigger, JumpTrigger::times);
  EXPECT_EQ(kick.times, (std::vector<double>{0.5, 2.0}));
  EXPECT_EQ(kick.evaluated, JumpValues::at_execution);
  EXPECT_TRUE(kick.guards.empty());
  EXPECT_EQ(jump_named(layout, "tick").every, 0.25);
}

TEST(LayoutOf, GroupsByIndicator) {
  Builder model("regions");
  const SX x = model.state("x", {1.0});
  model.dynamics("x", SX(0));
  model.region(x, {{"x", SX(1)}}, "left");
  model.region(-x, {{"x", SX(-1)}}, "right");
  const Layout layout = layout_of(finished(model));
  ASSERT_EQ(layout.groups.size(), 1U);
  EXPECT_EQ(layout.groups[0].regions, 2);
  EXPECT_EQ(layout.groups[0].mode_names, (Names{"left", "right"}));
  const auto first = static_cast<std::size_t>(layout.groups[0].first);
  for (std::size_t i = first; i < first + 2; ++i) EXPECT_EQ(layout.surfaces[i].role, SwitchingRole::region);
}

TEST(LayoutOf, ContactsHaveNoStates) {
  Builder model("ball");
  const SX y = model.state("y", {1.0}), x = model.state("x", {0.0});
  model.state("vy", {0.0});
  model.state("vx", {1.0});
  model.mechanics({.positions = {"y", "x"}, .velocities = {"vy", "vx"}, .potential = 9.81 * y});
  model.contact("ground", y, {.tangent = {{"x", 1}}, .friction = SX(0.3)});
  const System system = finished(model);
  const Layout layout = layout_of(system);
  ASSERT_EQ(layout.contacts.size(), 1U);
  EXPECT_EQ(layout.contacts[0].name, "ground");
  EXPECT_TRUE(layout.contacts[0].has_friction);
  EXPECT_EQ(system.x.numel(), 4);
  EXPECT_EQ(system.contacts.activities.numel(), Activity::constants);
  EXPECT_EQ(layout.positions, (std::vector<int>{0, 1}));
  EXPECT_EQ(layout.velocities, (std::vector<int>{2, 3}));
  const auto jump = static_cast<std::size_t>(layout.contacts[0].jump);
  EXPECT_FALSE(layout.jumps[jump].guards.empty());
}

}  // namespace
}  // namespace saltus::model
