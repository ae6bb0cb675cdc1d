// States that change by jumps only, and comparisons of them.
#include <functional>

#include "model_text.hpp"
#include "saltus/model/builder.hpp"

namespace saltus::model {
namespace {

ModelText machine(const std::string& rate_of_x) {
  return {.states = {{"x", "1"}, {"n", "0"}, {"last", "0"}}, .dynamics = {{"x", rate_of_x}, {"n", "0"}, {"last", "0"}}};
}

/// Alphas by the signs of their psi, discrete ones on their surface as written.
std::vector<double> alphas_as_written(const System& system, const std::vector<double>& x) {
  auto alpha = alphas_at(system, x);
  for (std::size_t j = 0; j < alpha.size(); ++j) {
    const auto& function = system.switching[j];
    if (function.role != SwitchingRole::discrete || value(system, function.psi, x, alpha) != 0.0) continue;
    alpha[j] = function.alpha_at_zero;
  }
  return alpha;
}

/// Of the function of this name; a kink if it has gone, as one without a use does.
SwitchingRole role_of(const System& system, const std::string& name) {
  for (const auto& function : system.switching) {
    if (function.name == name || function.name == name + "-0") return function.role;
  }
  return SwitchingRole::kink;
}

double rate_of_x(const System& system, double n) {
  const std::vector<double> x{1.0, n, 0.0};
  return values(system, system.f, x, alphas_as_written(system, x)).at(0);
}

TEST(DiscreteStates, HaveDynamicsOfNumbersThatComeToZero) {
  const System system =
      built({.parameters = {{"k", "0"}},
             .states = {{"a", "1"}, {"b", "1"}, {"c", "1"}, {"d", "1"}, {"e", "1"}, {"f", "1"}},
             .definitions = {{"none", "still*3"}, {"still", "2-2^1"}},
             .dynamics = {
                 {"a", "0"}, {"b", "-none"}, {"c", "k"}, {"d", "0/2+1e-300"}, {"e", "-0"}, {"f", "if(a == 1, 0, 0)"}}});
  // A parameter that happens to be 0, or a choice between zeros, makes no comparisons as written; the rate of f is 0.
  EXPECT_EQ(system.discrete_states, (std::vector<bool>{true, true, false, false, true, true}));
}

TEST(DiscreteStates, AComparisonOfThemIsDecidedAsWritten) {
  struct Case {
    std::string text;
    double below, at, above;
    std::size_t functions;
  };
  const std::vector<Case> cases{
      {"if(n > 2, 5, 3)", 3, 3, 5, 1},
      {"if(n >= 2, 5, 3)", 3, 5, 5, 1},
      {"if(n < 2, 5, 3)", 5, 3, 3, 1},
      {"if(n <= 2, 5, 3)", 5, 5, 3, 1},
      {"if(2 <= n, 5, 3)", 3, 5, 5, 1},
      {"if(n == 2, 5, 3)", 3, 5, 3, 2},
      {"if(n != 2, 5, 3)", 5, 3, 5, 2},
      {"if(not (n <= 2), 5, 3)", 3, 3, 5, 1},
      {"sign(n - 2)", -1, 0, 1, 1},
      {"step(n - 2)", 0, 0.5, 1, 1},
      {"abs(n - 2)", 1, 0, 1, 1},
      {"max(n, 2)", 2, 2, 3, 1},
      {"if(n > 2, 1, 0) + if(n >= 2, 10, 20)", 20, 10, 11, 2},
      {"if(n < 2, 1, 0) + if(n >= 2, 10, 20)", 21, 10, 10, 1},     // the negation: one function
      {"if(2*n > 4, 1, 0) + if(4 < 2*n, 10, 20)", 20, 20, 11, 1},  // a multiple
      {"if(n > 2, 1, 0) + sign(n - 2) + abs(n - 2)", 0, 0, 3, 2},  // what has no value at 0 shares either
      {"if(n == 2 and last == 0, 1, 0)", 0, 1, 0, 4},
      {"if(n == 2, 1, if(n == 3, 2, 4))", 4, 1, 2, 4},
      {"if(max(n, 1) >= 2, 1, 0)", 0, 1, 1, 2},
      {"if(sign(n - 2) >= 0, 1, 0)", 0, 1, 1, 2},
      {"if(sign(n - 2) > 0, 1, 0)", 0, 0, 1, 2},
  };
  for (const auto& [text, below, at, above, functions] : cases) {
    const System system = built(machine(text));
    EXPECT_EQ(rate_of_x(system, 1.0), below) << text;
    EXPECT_EQ(rate_of_x(system, 2.0), at) << text;
    EXPECT_EQ(rate_of_x(system, 3.0), above) << text;
    EXPECT_EQ(system.switching.size(), functions) << text;
    for (const auto& function : system.switching) EXPECT_EQ(function.role, SwitchingRole::discrete) << text;
  }
}

TEST(DiscreteStates, WhatMakesAJumpHasAColumnOfItsOwnName) {
  EXPECT_EQ(columns(built(machine("if(n > 2, 1, 0) + if(n >= 2, 10, 20) + sign(n - 2)"))),
            (Names{"n-2", "n-2>=0", "step(n-2)"}));
  EXPECT_EQ(columns(built(machine("if(n == 2, 5, 3)"))), (Names{"n-2", "2-n"}));
  EXPECT_EQ(columns(built(machine("x*max(n, 2)"))), Names{});
  ModelText named = machine("if(full >= 0, 1, 0) + if(full > 0, 1, 0)");
  named.switching = {{"full", "n-2"}};
  const System system = built(named);
  EXPECT_EQ(columns(system), (Names{"full", "full>0"}));
  EXPECT_EQ(system.switching[0].alpha_at_zero, 1.0);
  EXPECT_EQ(system.switching[1].alpha_at_zero, 0.0);
}

TEST(DiscreteStates, WithTimeOrMovingStatesAFunctionIsListed) {
  const System system = built(machine("if(t - last > 1, 1, 0) + if(x > n, 1, 0) + if(t > 3, 1, 0)"));
  ASSERT_EQ(system.switching.size(), 3U);
  EXPECT_EQ(system.switching[0].role, SwitchingRole::listed);
  EXPECT_EQ(system.switching[1].role, SwitchingRole::listed);
  EXPECT_EQ(system.switching[2].role, SwitchingRole::time_event);
}

TEST(DiscreteStates, WhatTheyMakeJumpIsListedThoughTheyRarelyDo) {
  const std::vector<std::string> jumping{
      "if(n == 1, -sign(x), 1)",
      "if(n == 1 and last == 7, -sign(x), 1)",
      "if(n != 1 and last == 7, -sign(x), 1)",
      "if(n == 1 and last >= 3 and last < 4, -sign(x), 1)",
      "if(n == 1, 1, if(n == 2, 1, if(n == last, sign(x), 1)))",
      "if(n == 3 and x > -2, sign(x), 2)",
      "if(floor(t) == 57, -sign(x), 1)",
      "if(n == -0.3, if(x > 0, 1, 2), 0)",
      "if(n == 1, 0, 2)*sign(x)",
  };
  for (const auto& text : jumping) {
    const System system = built(machine(text));
    EXPECT_EQ(role_of(system, "x"), SwitchingRole::listed) << text;
  }
  // What jumps for no value of n does not: two conditions that exclude each other, on their surfaces, too.
  const std::vector<std::string> continuous{
      "if(n == 1, abs(x), 1)",
      "if(n == 1 and n == 2, sign(x), 1) + max(x, 0)",
      "if(n > 1 and n < 1, sign(x), 1)",
      "if(n < 1, 1, 0)*if(n > 1, 1, 0)*sign(x)",
      "(if(n == 1, 1, 0) - if(n == 1, 1, 0))*sign(x)",
  };
  for (const auto& text : continuous) {
    const System system = built(machine(text));
    EXPECT_EQ(role_of(system, "x"), SwitchingRole::kink) << text;
  }
}

TEST(DiscreteStates, EqualityOfWhatMovesIsRefused) {
  for (const auto* text : {"if(x == 2, 1, 0)", "if(n == t, 1, 0)", "if(n != step(x), 1, 0)", "if(abs(x) == n, 1, 0)"}) {
    const Error error = refused(machine(text));
    EXPECT_NE(error.message.find("moves"), std::string::npos) << text << error.message;
    EXPECT_NE(error.remedy.find(">="), std::string::npos) << text << error.remedy;
    EXPECT_EQ(error.location.line, 4) << text;
  }
  const System folded = built(machine("if(2 == 2, 1, 0) + if(2 != 2, 4, 0)"));
  EXPECT_EQ(rate_of_x(folded, 0.0), 1.0);
}

Expected<System> with_modes(const std::vector<std::string>& conditions) {
  Description description = describe({.states = {{"x", "1"}, {"q", "0"}}, .dynamics = {{"q", "0"}}});
  for (std::size_t i = 0; i < conditions.size(); ++i) {
    ModeDescription mode;
    mode.when = parsed(conditions[i], {"model.toml", 20 + static_cast<int>(i), 1});
    mode.dynamics = {{"x", expression::number(static_cast<double>(i), {}), {}}};
    description.modes.push_back(mode);
  }
  return build(description, {});
}

TEST(DiscreteStates, ModesOfThemCoverEveryValueOnce) {
  for (const auto& conditions : std::vector<std::vector<std::string>>{{"q < 1", "q == 1", "q > 1"},
                                                                      {"q == 0", "q == 1", "otherwise"},
                                                                      {"q <= 1", "q > 1"},
                                                                      {"q != 3", "q == 3"}}) {
    const auto system = with_modes(conditions);
    EXPECT_TRUE(system.has_value()) << conditions[0] << (system ? "" : to_text(system.error()));
  }
  for (const auto& conditions : std::vector<std::vector<std::string>>{
           {"q <= 1", "q == 1", "q > 1"}, {"q < 1", "q > 1"}, {"q == 0", "q == 1"}, {"q <= 1", "q >= 1"}}) {
    EXPECT_FALSE(with_modes(conditions).has_value()) << conditions[0] << ", " << conditions[1];
  }
  const auto system = with_modes({"q < 1", "q == 1", "q > 1"});
  ASSERT_TRUE(system.has_value());
  for (const auto& [q, rate] : {std::pair{0.0, 0.0}, std::pair{1.0, 1.0}, std::pair{2.0, 2.0}}) {
    const std::vector<double> x{1.0, q};
    EXPECT_EQ(values(*system, system->f, x, alphas_as_written(*system, x)).at(0), rate) << q;
  }
}

TEST(DiscreteStates, AMachineOfAHundredModesIsRead) {
  std::vector<std::string> conditions;
  for (int i = 0; i < 100; ++i) conditions.push_back("q == " + std::to_string(i));
  const auto without = with_modes(conditions);
  ASSERT_FALSE(without.has_value());
  EXPECT_NE(without.error().message.find("leave uncovered 101 sign patterns"), std::string::npos)
      << without.error().message;
  conditions.emplace_back("otherwise");
  const auto system = with_modes(conditions);
  ASSERT_TRUE(system.has_value()) << to_text(system.error());
  EXPECT_EQ(system->switching.size(), 200U);
  for (const auto& [q, rate] : {std::pair{41.0, 41.0}, std::pair{41.5, 100.0}, std::pair{-1.0, 100.0}}) {
    const std::vector<double> x{1.0, q};
    EXPECT_EQ(values(*system, system->f, x, alphas_as_written(*system, x)).at(0), rate) << q;
  }
}

TEST(DiscreteStates, TheirInitialValuesCanBeSet) {
  const System system = built(machine("n"), {set("n", "3")});
  EXPECT_EQ(system.initial_state, (std::vector<double>{1.0, 3.0, 0.0}));
}

TEST(DiscreteStates, InCppTheyAreDeclared) {
  Builder model("counter");
  const auto x = model.state("x", {.initial = 1.0});
  const auto n = model.discrete_state("n", 0.0);
  model.dynamics("x", model.if_(equal(n, 2.0), 5.0, 3.0));
  model.jump(x, Direction::down, {{"x", 1.0}, {"n", n + 1.0}}, {.name = "reset"});
  model.jump(not_equal(n, 2.0) && greater(x, 4.0), {{"n", 2.0}}, {.at_start = true, .priority = x, .delay = 0.5});
  model.jump_at({1.0, 2.0}, {{"n", 0.0}});
  model.jump_every(0.25, {{"x", 2.0 * x}}, {.persistent = true, .values = JumpValues::at_execution});
  const auto system = model.build();
  ASSERT_TRUE(system.has_value()) << to_text(system.error());
  EXPECT_EQ(system->discrete_states, (std::vector<bool>{false, true}));
  ASSERT_EQ(system->jumps.size(), 4U);
  EXPECT_EQ(system->jumps[0].name, "reset");
  EXPECT_EQ(system->jumps[0].trigger, JumpTrigger::guard_down);
  EXPECT_EQ(system->jumps[0].targets, (std::vector<int>{1, 0}));
  EXPECT_EQ(system->jumps[1].name, "jump2");
  EXPECT_EQ(system->jumps[1].guards.numel(), 3);
  EXPECT_TRUE(system->jumps[1].at_start);
  EXPECT_EQ(value(*system, system->jumps[1].delay, {0, 0}, {0, 0}), 0.5);
  EXPECT_EQ(value(*system, system->jumps[1].priority, {3, 0}, {0, 0}), 3.0);
  EXPECT_EQ(system->jumps[2].times, (std::vector<double>{1.0, 2.0}));
  EXPECT_EQ(system->jumps[3].every, 0.25);
  EXPECT_EQ(system->jumps[3].evaluated, JumpValues::at_execution);
  EXPECT_TRUE(system->warnings.empty());
  model.dynamics("n", n);
  EXPECT_NE(model.build().error().message.find("two right-hand sides"), std::string::npos);
}

TEST(DiscreteStates, MistakesInCppAreKept) {
  const auto mistake = [](const std::function<void(Builder&, const casadi::SX&)>& state) {
    Builder model("mistake");
    const auto x = model.state("x", {.initial = 1.0});
    model.dynamics("x", 1.0);
    state(model, x);
    const auto system = model.build();
    EXPECT_FALSE(system.has_value());
    return system ? std::string() : system.error().message;
  };
  EXPECT_NE(mistake([](Builder& m, const auto& x) {
              m.jump(x, Direction::up, {{"y", 1.0}});
            }).find("'y'"),
            std::string::npos);
  EXPECT_NE(mistake([](Builder& m, const auto& x) { m.jump(x, Direction::up, {}); }).find("sets no state"),
            std::string::npos);
  EXPECT_NE(mistake([](Builder& m, const auto&) {
              m.jump_every(-1.0, {{"x", 1.0}});
            }).find("is -1"),
            std::string::npos);
  EXPECT_NE(mistake([](Builder& m, const auto&) { m.jump_at({}, {{"x", 1.0}}); }).find("no times"), std::string::npos);
  EXPECT_NE(mistake([](Builder& m, const auto&) {
              m.jump_at({2.0, 1.0}, {{"x", 1.0}});
            }).find("ascend"),
            std::string::npos);
  EXPECT_NE(mistake([](Builder& m, const auto& x) {
              m.jump(equal(x, 2.0), {{"x", 1.0}});
            }).find("moves"),
            std::string::npos);
  EXPECT_NE(mistake([](Builder& m, const auto& x) { m.output("y", m.if_(equal(x, 2.0), 1.0, 0.0)); }).find("moves"),
            std::string::npos);
  EXPECT_NE(mistake([](Builder& m, const auto& x) {
              m.jump(x, Direction::up, {{"x", 1.0}}, {.delay = -1.0});
            }).find("delay"),
            std::string::npos);
}

TEST(DiscreteStates, OneThatIsKnownTooLateIsWarnedOf) {
  Builder model("late");
  const auto x = model.state("x", {.initial = 1.0});
  const auto n = model.state("n", {.initial = 0.0});
  model.dynamics("n", 0.0);
  model.dynamics("x", model.if_(greater(n, 2.0), 5.0, 3.0) - x);
  const auto system = model.build();
  ASSERT_TRUE(system.has_value()) << to_text(system.error());
  EXPECT_EQ(system->discrete_states, (std::vector<bool>{false, true}));
  ASSERT_EQ(system->warnings.size(), 1U);
  EXPECT_NE(system->warnings[0].find("discrete_state()"), std::string::npos) << system->warnings[0];
}

}  // namespace
}  // namespace saltus::model
