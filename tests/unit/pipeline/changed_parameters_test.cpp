// Systems whose parameters are changed after they were built: right results, or refused.
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "saltus/expression/parser.hpp"
#include "saltus/model/build.hpp"
#include "saltus/model/builder.hpp"
#include "saltus/pipeline/options/stated_run.hpp"
#include "saltus/pipeline/simulate.hpp"
#include "saltus/pipeline/sweep.hpp"

namespace saltus::pipeline {
namespace {

using casadi::SX;
using model::Builder;
using model::System;

/// The message, or the result: the last value of the first state.
struct Outcome {
  std::string refused{};
  double x = 0.0;
};

Outcome simulated(const System& system, const SimulateOptions& options) {
  const auto run = simulate(system, options);
  if (!run) return {.refused = run.error().message};
  return {.x = run->final.x[0]};
}

System built(Builder& builder) {
  auto system = builder.build();
  EXPECT_TRUE(system.has_value()) << (system ? "" : to_text(system.error()));
  return system ? *system : System{};
}

System two_steps(double a_value, double b_value) {
  Builder m("two steps");
  const SX a = m.parameter("a", a_value), b = m.parameter("b", b_value), x = m.state("x", {0.0});
  const SX above_a = m.step(x - a), above_b = m.step(x - b);
  m.dynamics("x", 1 + above_a + above_b);
  return built(m);
}

TEST(ChangedParametersTest, WhatCoincidesIsBuiltAnew) {
  auto system = two_steps(1, 1);
  EXPECT_NEAR(simulated(two_steps(1, 2), {.until = 3.0}).x, 6.5, 1e-8);
  system.parameter_values[1] = 2;
  EXPECT_EQ(simulated(system, {.until = 3.0}).refused,
            "the system was built for b = 1: '(x-a)' and '(x-b)' are one switching function, which does not hold for "
            "b = 2");
  system.parameter_values[0] = 2;
  EXPECT_NEAR(simulated(system, {.until = 3.0}).x, simulated(two_steps(2, 2), {.until = 3.0}).x, 1e-8);
}

TEST(ChangedParametersTest, WhatBeginsToCoincideIsBuiltAnew) {
  auto system = two_steps(1, 2);
  system.parameter_values[1] = 1.5;
  EXPECT_NEAR(simulated(system, {.until = 3.0}).x, simulated(two_steps(1, 1.5), {.until = 3.0}).x, 1e-8);
  system.parameter_values[1] = 1;
  EXPECT_NE(simulated(system, {.until = 3.0}).refused.find("are two switching functions"), std::string::npos);
}

System brake(double mu_value) {
  Builder m("brake");
  const SX mu = m.parameter("mu", mu_value), x = m.state("x", {0.0}), v = m.state("v", {3.0});
  m.dynamics("x", v);
  m.dynamics("v", -0.4 * x - mu * m.sign(v));
  return built(m);
}

TEST(ChangedParametersTest, FrictionThatWasNoneIsBuiltAnew) {
  auto system = brake(0);
  system.parameter_values[0] = 2;
  EXPECT_EQ(simulated(system, {.until = 6.0}).refused,
            "the system was built for mu = 0: nothing jumps where 'v' is 0, which does not hold for mu = 2");
  system = brake(2);
  system.parameter_values[0] = 0.5;
  EXPECT_NEAR(simulated(system, {.until = 6.0}).x, simulated(brake(0.5), {.until = 6.0}).x, 1e-8);
  system.parameter_values[0] = 0;
  EXPECT_NEAR(simulated(system, {.until = 6.0}).x, simulated(brake(0), {.until = 6.0}).x, 1e-6);
}

System stop(double k_value, double gap_value, double limit) {
  Builder m("stop");
  const SX k = m.parameter("k", k_value), gap = m.parameter("gap", gap_value), n = m.parameter("n", limit);
  const SX x = m.state("x", {0.0}), v = m.state("v", {2.0});
  m.dynamics("x", v);
  m.dynamics("v", -k * m.max(0, x - gap) - m.if_(model::greater(n, 3), 0.1 * v, 0));
  return built(m);
}

TEST(ChangedParametersTest, KinksAndConstantsThatStayAreFree) {
  auto system = stop(10, 1, 5);
  system.parameter_values = {40, 0.5, 4};
  EXPECT_NEAR(simulated(system, {.until = 2.0}).x, simulated(stop(40, 0.5, 4), {.until = 2.0}).x, 1e-8);
  system.parameter_values[2] = 2;
  EXPECT_EQ(simulated(system, {.until = 2.0}).refused,
            "the system was built for n = 5: '(n-3)' is positive, which does not hold for n = 2");
}

TEST(ChangedParametersTest, OfASweepAreRefusedInTheirRun) {
  const auto system = two_steps(1, 1);
  const auto state = [&](std::size_t run) -> Expected<StatedRun> {
    StatedRun stated{system, {.until = 3.0}};
    stated.system.parameter_values[1] = run == 0 ? 1.0 : 2.0;
    return stated;
  };
  const auto runs = sweep({.runs = 2}, state);
  ASSERT_FALSE(runs.has_value());
  EXPECT_NE(to_text(runs.error()).find("in run 2"), std::string::npos);
}

TEST(ChangedParametersTest, NumbersOfAnotherCountAreRefused) {
  auto system = brake(1);
  system.parameter_values.push_back(1);
  EXPECT_EQ(simulated(system, {.until = 1.0}).refused, "parameter_values has 2 numbers for 1 names");
  system = brake(1);
  system.initial_state.pop_back();
  EXPECT_EQ(simulated(system, {.until = 1.0}).refused, "initial_state has 1 numbers for 2 names");
}

expression::NodePtr tree(const std::string& text) { return *expression::parse(text, {}); }

/// x(0) = a, x' = -b x with b = 2 a.
System computed() {
  model::Description d;
  d.name = "computed";
  d.parameters = {{"a", tree("1"), {}}, {"b", tree("2*a"), {}}};
  d.states = {{.name = "x", .initial = tree("a"), .lower = tree("-a"), .upper = tree("10*a"), .location = {}}};
  d.dynamics = {{"x", tree("-b*x"), {}}};
  auto system = model::build(d);
  EXPECT_TRUE(system.has_value()) << (system ? "" : to_text(system.error()));
  return system ? *system : System{};
}

TEST(ChangedParametersTest, NumbersThatWereComputedAreStatedToo) {
  auto system = computed();
  system.parameter_values[0] = 3;
  EXPECT_EQ(simulated(system, {.until = 1.0}).refused,
            "the system was built for a = 1: the parameter 'b' is 2, which does not hold for a = 3");
  system.parameter_values[1] = 6;
  EXPECT_EQ(simulated(system, {.until = 1.0}).refused,
            "the system was built for a = 1: the initial value of state 'x' is 1, which does not hold for a = 3");
  system.initial_state[0] = 3;
  EXPECT_NEAR(simulated(system, {.until = 1.0}).x, 3 * std::exp(-6.0), 1e-8);
  system = computed();
  system.parameter_values[1] = 1;
  EXPECT_NEAR(simulated(system, {.until = 1.0}).x, std::exp(-1.0), 1e-8);
}

}  // namespace
}  // namespace saltus::pipeline
