// [[jumps]] on their way from a description into a system.
#include "model_text.hpp"

namespace saltus::model {
namespace {

/// A jump whose `when` stands on line `line`; its triggers and targets are given as text.
JumpDescription jump(const std::string& when, const Table& set, JumpTrigger trigger = JumpTrigger::condition,
                     int line = 30) {
  JumpDescription description;
  description.trigger = trigger;
  description.location = {"model.toml", line, 1};
  if (!when.empty()) description.when = parsed(when, {"model.toml", line + 1, 9});
  for (const auto& [name, text] : set) {
    description.set.push_back({name, parsed(text, {"model.toml", line + 2, 9}), {"model.toml", line + 2, 3}});
  }
  return description;
}

ModelText ball() {
  return {.parameters = {{"e", "0.5"}, {"g", "9.81"}},
          .states = {{"y", "1"}, {"v", "0"}, {"n", "0"}},
          .dynamics = {{"y", "v"}, {"v", "-g"}, {"n", "0"}}};
}

Expected<System> with_jumps(const ModelText& text, const std::vector<JumpDescription>& jumps) {
  Description description = describe(text);
  description.jumps = jumps;
  return build(description, {});
}

System system_with(const ModelText& text, const std::vector<JumpDescription>& jumps) {
  auto system = with_jumps(text, jumps);
  EXPECT_TRUE(system.has_value()) << (system ? "" : to_text(system.error()));
  return system ? *system : System{};
}

Error refused_jump(const JumpDescription& jump, const ModelText& text = ball()) {
  const auto system = with_jumps(text, {jump});
  EXPECT_FALSE(system.has_value()) << "the model was accepted";
  return system ? Error{} : system.error();
}

/// Truth of a jump's condition at a point, its comparisons read as written.
bool holds(const System& system, const Jump& jump, const std::vector<double>& x, double t = 0.0) {
  const auto alpha = alphas_at(system, x, t);
  std::vector<double> steps;
  const auto guards = values(system, jump.guards, x, alpha, t);
  for (std::size_t i = 0; i < guards.size(); ++i) {
    steps.push_back(guards[i] > 0.0 || (guards[i] == 0.0 && jump.true_at_equality[i]) ? 1.0 : 0.0);
  }
  const casadi::Function f("f", {system.t, system.x, system.p, system.alpha, jump.guard_alpha}, {jump.value});
  const double value(f(std::vector<casadi::DM>{t, x, system.parameter_values, alpha, steps}).at(0));
  EXPECT_TRUE(value == 0.0 || value == 1.0) << value;
  return value == 1.0;
}

TEST(Jumps, AGuardWithADirectionIsItsExpression) {
  JumpDescription bounce = jump("2*y", {{"v", "-e*v"}, {"n", "n+1"}}, JumpTrigger::guard_down);
  bounce.name = "bounce";
  const System system = system_with(ball(), {bounce});
  ASSERT_EQ(system.jumps.size(), 1U);
  const Jump& found = system.jumps[0];
  EXPECT_EQ(found.name, "bounce");
  EXPECT_TRUE(found.named);
  EXPECT_EQ(found.trigger, JumpTrigger::guard_down);
  ASSERT_EQ(found.guards.numel(), 1);
  EXPECT_EQ(value(system, found.guards, {0.5, 3.0, 2.0}, {}), 1.0);
  EXPECT_EQ(found.targets, (std::vector<int>{1, 2}));
  EXPECT_EQ(values(system, found.values, {0.5, 3.0, 2.0}, {}), (std::vector<double>{-1.5, 3.0}));
  EXPECT_EQ(value(system, found.priority, {0, 0, 0}, {}), 0.0);
  EXPECT_EQ(value(system, found.delay, {0, 0, 0}, {}), 0.0);
  EXPECT_EQ(system.discrete_states, (std::vector<bool>{false, false, true}));
}

TEST(Jumps, ConditionsHoldAsWritten) {
  const System system = system_with(ball(), {jump("y <= 0 and v < 0 or not (t < 2)", {{"v", "0"}}),
                                             jump("abs(v) > max(y, 1)", {{"n", "1"}}), jump("1 > 2", {{"n", "1"}})});
  ASSERT_EQ(system.jumps.size(), 3U);
  EXPECT_EQ(system.jumps[1].name, "jump2");
  EXPECT_FALSE(system.jumps[1].named);
  const auto& first = system.jumps[0];
  EXPECT_TRUE(holds(system, first, {0.0, -1.0, 0.0}));
  EXPECT_FALSE(holds(system, first, {0.0, 0.0, 0.0}));
  EXPECT_FALSE(holds(system, first, {1e-300, -1.0, 0.0}));
  EXPECT_TRUE(holds(system, first, {1.0, 1.0, 0.0}, 2.0));
  const auto& second = system.jumps[1];
  EXPECT_TRUE(holds(system, second, {0.5, -1.25, 0.0}));
  EXPECT_FALSE(holds(system, second, {1.5, -1.25, 0.0}));
  EXPECT_FALSE(holds(system, system.jumps[2], {0.0, 0.0, 0.0}));
  ASSERT_EQ(system.warnings.size(), 2U);  // the other one: parameter e is not used
  EXPECT_NE(system.warnings[1].find("31: jump 'jump3' never happens"), std::string::npos) << system.warnings[1];
}

TEST(Jumps, TimesAndDelaysAreExpressionsOfParameters) {
  JumpDescription clock = jump("", {{"n", "n+1"}}, JumpTrigger::times);
  clock.every = parsed("e/2", {});
  clock.delay = parsed("y+t", {});
  clock.priority = parsed("-n", {});
  JumpDescription list = jump("", {{"n", "0"}}, JumpTrigger::times);
  list.at = {parsed("1", {}), parsed("3*e", {})};
  const System system = system_with(ball(), {clock, list});
  EXPECT_EQ(system.jumps[0].every, 0.25);
  EXPECT_EQ(system.jumps[0].guards.numel(), 0);
  EXPECT_EQ(value(system, system.jumps[0].delay, {2.0, 0.0, 5.0}, {}, 1.0), 3.0);
  EXPECT_EQ(value(system, system.jumps[0].priority, {2.0, 0.0, 5.0}, {}, 1.0), -5.0);
  EXPECT_EQ(system.jumps[1].times, (std::vector<double>{1.0, 1.5}));
}

TEST(Jumps, ComparisonsOfTheirExpressionsAreNoSwitchingFunctions) {
  const System system = system_with(ball(), {jump("y < 0", {{"v", "if(v < -1, 1, 2)"}})});
  EXPECT_TRUE(system.switching.empty());
  EXPECT_EQ(values(system, system.jumps[0].values, {0, -2, 0}, {}), (std::vector<double>{1.0}));
  EXPECT_EQ(values(system, system.jumps[0].values, {0, -1, 0}, {}), (std::vector<double>{2.0}));
}

TEST(Jumps, WrongTriggersAreRefused) {
  const Error condition = refused_jump(jump("y < 0", {{"v", "0"}}, JumpTrigger::guard_down));
  EXPECT_NE(condition.message.find("`direction` with the condition 'y<0'"), std::string::npos) << condition.message;
  EXPECT_EQ(condition.location.line, 31);
  const Error guard = refused_jump(jump("y", {{"v", "0"}}));
  EXPECT_NE(guard.message.find("expected a condition"), std::string::npos) << guard.message;
  EXPECT_NE(guard.remedy.find("direction"), std::string::npos) << guard.remedy;
  EXPECT_EQ(guard.location.line, 31);
  JumpDescription clock = jump("", {{"n", "0"}}, JumpTrigger::times);
  for (const auto* text : {"0", "-1", "e-e", "0/0"}) {
    clock.every = parsed(text, {"model.toml", 40, 1});
    EXPECT_EQ(refused_jump(clock).location.line, 40) << text;
  }
  clock.every = parsed("y", {"model.toml", 40, 1});
  EXPECT_NE(refused_jump(clock).message.find("must be a constant"), std::string::npos);
  clock.every = nullptr;
  clock.at = {parsed("2", {}), parsed("2", {"model.toml", 41, 1})};
  EXPECT_NE(refused_jump(clock).message.find("do not ascend"), std::string::npos);
  EXPECT_EQ(refused_jump(clock).location.line, 41);
}

TEST(Jumps, WrongAssignmentsAreRefused) {
  const Error unknown = refused_jump(jump("y < 0", {{"w", "0"}}));
  EXPECT_NE(unknown.message.find("expected the name of a state, found 'w'"), std::string::npos) << unknown.message;
  EXPECT_EQ(unknown.location.line, 32);
  const Error parameter = refused_jump(jump("y < 0", {{"e", "0"}}));
  EXPECT_NE(parameter.message.find("'e', which is a parameter"), std::string::npos) << parameter.message;
  EXPECT_NE(parameter.remedy.find("make it a state with dynamics 0"), std::string::npos) << parameter.remedy;
  EXPECT_NE(refused_jump(jump("y < 0", {})).message.find("sets no state"), std::string::npos);
  const Error twice = refused_jump(jump("y < 0", {{"v", "0"}, {"v", "1"}}));
  EXPECT_NE(twice.message.find("sets a state twice"), std::string::npos) << twice.message;
  JumpDescription negative = jump("y < 0", {{"v", "0"}});
  negative.delay = parsed("-e", {"model.toml", 44, 1});
  const Error delay = refused_jump(negative);
  EXPECT_NE(delay.message.find("the delay of the jump 'jump1' is -0.5"), std::string::npos) << delay.message;
  EXPECT_EQ(delay.location.line, 44);
  JumpDescription named = jump("y < 0", {{"v", "0"}});
  named.name = "g";
  EXPECT_NE(refused_jump(named).message.find("'g' is already a parameter"), std::string::npos);
}

}  // namespace
}  // namespace saltus::model
