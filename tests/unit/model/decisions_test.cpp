// What was decided with values of parameters, asked again with others.
#include "saltus/model/decisions.hpp"

#include <algorithm>
#include <map>

#include "model_text.hpp"
#include "saltus/model/builder.hpp"

namespace saltus::model {
namespace {

using casadi::SX;

/// Why the system may not have these values; empty: it may.
std::string stale(System system, const std::map<std::string, double>& changed) {
  for (const auto& [name, value] : changed) {
    const auto place = std::find(system.parameter_names.begin(), system.parameter_names.end(), name);
    EXPECT_NE(place, system.parameter_names.end()) << name;
    system.parameter_values[static_cast<std::size_t>(place - system.parameter_names.begin())] = value;
  }
  const auto error = find_stale(system);
  return error ? error->message : "";
}

System of(const Table& parameters, const Table& dynamics, const Table& states = {{"x", "1"}, {"v", "-1"}}) {
  return built({.parameters = parameters, .states = states, .dynamics = dynamics});
}

TEST(DecisionsTest, SystemsWithoutParametersHaveNone) {
  EXPECT_EQ(of({}, {{"x", "sign(x) + abs(v)"}, {"v", "0"}}).decisions, nullptr);
}

TEST(DecisionsTest, MultiplesAreFreeWhileTheyAreMultiples) {
  const auto system =
      of({{"a", "2"}, {"b", "3"}}, {{"x", "sign(a*x - b) + step(b - a*x) + sign(2*x - 3)"}, {"v", "-x"}});
  EXPECT_EQ(system.switching.size(), 1U);
  EXPECT_EQ(stale(system, {{"a", 4.0}, {"b", 6.0}}), "");
  EXPECT_EQ(stale(system, {{"a", 4.0}}),
            "the system was built for a = 2: 'a*x-b' and '((2.*x)-3)' are one switching function, which does not hold "
            "for a = 4");
  EXPECT_EQ(stale(of({{"a", "2"}}, {{"x", "sign(x - a) + step(a - x)"}, {"v", "-x"}}), {{"a", 5.0}}), "");
}

TEST(DecisionsTest, ConstantsAreFreeWhileTheyHaveTheirSign) {
  const auto system = of({{"k", "5"}}, {{"x", "if(k > 3, v, 1)"}, {"v", "-x"}});
  EXPECT_EQ(stale(system, {{"k", 4.0}}), "");
  EXPECT_NE(stale(system, {{"k", 3.0}}).find("'k-3' is positive"), std::string::npos);
  const auto equal = of({{"n", "2"}}, {{"x", "if(n == 2, v, 1)"}, {"v", "-x"}});
  EXPECT_NE(stale(equal, {{"n", 1.0}}).find("'(n-2)' is 0"), std::string::npos);
}

TEST(DecisionsTest, StepsOfStepsAreFreeWhileTheirCornersHaveTheirSigns) {
  const auto system = of({{"k", "2"}}, {{"x", "step(k*step(v) - 1)"}, {"v", "-x"}});
  EXPECT_EQ(stale(system, {{"k", 3.0}}), "");
  EXPECT_NE(stale(system, {{"k", 0.5}}).find("is positive, which does not hold for k = 0.5"), std::string::npos);
}

TEST(DecisionsTest, KinksAreFreeWhileNothingJumps) {
  const auto system =
      of({{"k", "2"}, {"mu", "0"}, {"gap", "1"}}, {{"x", "v"}, {"v", "-k*max(0, x - gap) - mu*sign(v)"}});
  EXPECT_EQ(stale(system, {{"k", 100.0}, {"gap", -0.3}}), "");
  EXPECT_EQ(stale(system, {{"k", 100.0}, {"mu", 0.1}}),
            "the system was built for k = 2, mu = 0: nothing jumps where 'v' is 0, which does not hold for k = 100, "
            "mu = 0.1");
}

TEST(DecisionsTest, FrictionIsFree) {
  const auto system = of({{"mu", "0.5"}, {"belt", "0.2"}}, {{"x", "v"}, {"v", "-x - mu*sign(v - belt)"}});
  for (const double mu : {0.0, 1e-9, 3.0, -2.0}) EXPECT_EQ(stale(system, {{"mu", mu}, {"belt", 0.4}}), "");
}

TEST(DecisionsTest, ThresholdsOfModesKeepTheirOrder) {
  Builder model("bands");
  const SX a = model.parameter("a", 1.0), b = model.parameter("b", 2.0), x = model.state("x", {0.0});
  model.mode(less(x, a), {{"x", 1}});
  model.mode(greater(x, b), {{"x", -1}});
  model.otherwise({{"x", 0.5}});
  const auto system = model.build();
  ASSERT_TRUE(system) << to_text(system.error());
  EXPECT_EQ(stale(*system, {{"a", 1.5}, {"b", 9.0}}), "");
  EXPECT_NE(stale(*system, {{"a", 3.0}}).find("exclude signs of each other"), std::string::npos);
}

TEST(DecisionsTest, TablesOfConstantsKeepTheirCell) {
  Builder model("table");
  const SX k = model.parameter("k", 0.5), x = model.state("x", {0.0});
  const auto table = model.table("gain", {0, 1, 2}, {0, 1, 4});
  model.dynamics("x", table(k) - x);
  const auto system = model.build();
  ASSERT_TRUE(system) << to_text(system.error());
  EXPECT_EQ(stale(*system, {{"k", 0.7}}), "");
  EXPECT_NE(stale(*system, {{"k", 1.5}}).find("lies between two of its breaks"), std::string::npos);
}

TEST(DecisionsTest, GuardsThatFoldedKeepTheirSign) {
  Builder model("guard");
  const SX k = model.parameter("k", 1.0), x = model.state("x", {1.0});
  model.dynamics("x", SX(-1));
  model.jump(less(x, 0) && greater(k, 0), {{"x", 1}});
  const auto system = model.build();
  ASSERT_TRUE(system) << to_text(system.error());
  EXPECT_EQ(stale(*system, {{"k", 2.0}}), "");
  EXPECT_EQ(stale(*system, {{"k", -1.0}}),
            "the system was built for k = 1: 'k' is positive, which does not hold for k = -1");
}

TEST(DecisionsTest, FrictionOfContactsThatIsThereMayChange) {
  Builder model("block");
  const SX mu = model.parameter("mu", 0.3), x = model.state("x", {0.0}), z = model.state("z", {1.0});
  model.state("vx", {1.0});
  model.state("vz", {0.0});
  model.mechanics({.positions = {"x", "z"}, .velocities = {"vx", "vz"}, .potential = 9.81 * z});
  model.contact("ground", z, {.tangent = {{"x", 1}}, .friction = mu});
  const auto system = model.build();
  ASSERT_TRUE(system) << to_text(system.error());
  EXPECT_EQ(stale(*system, {{"mu", 0.6}}), "");
  EXPECT_NE(stale(*system, {{"mu", 0.0}}).find("the friction of 'ground' is positive"), std::string::npos);
}

TEST(DecisionsTest, NumbersOfTheModelThatWereComputedAreStale) {
  auto description =
      describe({.parameters = {{"a", "1"}, {"b", "2*a"}}, .states = {{"x", "a"}}, .dynamics = {{"x", "-b*x"}}});
  description.hysteresis.push_back({.name = "on",
                                    .input = parsed("x", {}),
                                    .on = parsed("3*a", {}),
                                    .off = parsed("0", {}),
                                    .initial = nullptr,
                                    .location = {}});
  auto system = build(description);
  ASSERT_TRUE(system) << to_text(system.error());
  EXPECT_NE(stale(*system, {{"a", 2.0}}).find("the parameter 'b' is 2"), std::string::npos);
  EXPECT_NE(stale(*system, {{"a", 2.0}, {"b", 4.0}}).find("the initial value of state 'x' is 1"), std::string::npos);
  system->initial_state[0] = 2.0;
  EXPECT_NE(stale(*system, {{"a", 2.0}, {"b", 4.0}}).find("`on` of 'on' is 3"), std::string::npos);
  EXPECT_EQ(stale(*system, {{"b", 7.0}}), "");
}

TEST(DecisionsTest, WhatIsBuiltAgainDecidesAgain) {
  Builder model("grows");
  const SX k = model.parameter("k", 1.0), x = model.state("x", {1.0});
  model.dynamics("x", -k * x);
  const auto first = model.build();
  model.output("sign_of_k", model.sign(k));
  const auto second = model.build();
  ASSERT_TRUE(first && second);
  EXPECT_EQ(stale(*first, {{"k", -1.0}}), "");
  EXPECT_NE(stale(*second, {{"k", -1.0}}), "");
}

}  // namespace
}  // namespace saltus::model
