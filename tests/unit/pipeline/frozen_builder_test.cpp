// Contacts and hysteresis stated in C++, by finite elements: time stands still there, as in models of files.
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "saltus/model/builder.hpp"
#include "saltus/pipeline/simulate.hpp"

namespace saltus::pipeline {
namespace {

using casadi::SX;
using model::Builder;
using model::System;

System made(Builder& builder) {
  auto system = builder.build();
  EXPECT_TRUE(system.has_value()) << (system ? "" : to_text(system.error()));
  return system ? *system : System{};
}

System ball(double height, double gravity, double restitution, double wind = 0.0) {
  Builder m("ball");
  const SX g = m.parameter("g", gravity), e = m.parameter("e", restitution);
  const SX x = m.state("x", {0.0}), z = m.state("z", {height}), vx = m.state("vx", {1.0}), vz = m.state("vz", {0.0});
  m.mechanics({.positions = {"x", "z"},
               .velocities = {"vx", "vz"},
               .potential = g * z,
               .force = {{"vx", wind * sin(m.time())}}});
  m.contact("ground", z, {.tangent = {{"x", 1}}, .friction = restitution > 0.0 ? 0.0 : 0.1, .restitution = e});
  return made(m);
}

SimulateOptions by(Method method, double until) {
  SimulateOptions options{.until = until, .method = method};
  options.fesd.steps = 40;
  options.fesd.stages = 3;
  return options;
}

result::Final end_of(const System& system, const SimulateOptions& options) {
  const auto run = simulate(system, options);
  EXPECT_TRUE(run.has_value()) << (run ? "" : to_text(run.error()));
  if (!run) return {};
  EXPECT_EQ(run->status.termination, result::Termination::completed) << run->status.message;
  return run->final;
}

void expect_same_end(const System& system, double until) {
  const auto exact = end_of(system, by(Method::event, until)), frozen = end_of(system, by(Method::fesd, until));
  ASSERT_GE(exact.x.size(), 4U);
  ASSERT_GE(frozen.x.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(frozen.x[i], exact.x[i], 1e-6) << "state " << i;
}

TEST(FrozenBuilderTest, ContactsWithFriction) { expect_same_end(ball(1.0, 9.81, 0.0), 1.0); }

TEST(FrozenBuilderTest, ForcesOfTime) { expect_same_end(ball(1.0, 9.81, 0.0, 5.0), 1.0); }

TEST(FrozenBuilderTest, ContactsWithRestitution) { expect_same_end(ball(1.0, 9.81, 0.5), 0.8); }

TEST(FrozenBuilderTest, HasTheValuesThatTheSystemHasByNow) {
  auto system = ball(1.0, 9.81, 0.0);
  system.initial_state[1] = 0.3;
  system.initial_state[2] = 2.0;
  system.parameter_values[0] = 5.0;
  expect_same_end(system, 1.0);
  const auto run = simulate(system, by(Method::fesd, 1.0));
  ASSERT_TRUE(run);
  ASSERT_FALSE(run->events.empty());
  EXPECT_NEAR(run->events[0].t, std::sqrt(2.0 * 0.3 / 5.0), 1e-6);
}

TEST(FrozenBuilderTest, WhatWasFrozenForANumberIsBuiltAnew) {
  auto system = ball(1.0, 9.81, 0.5);
  system.parameter_values[1] = 0.8;
  EXPECT_TRUE(simulate(system, by(Method::event, 0.8)));
  const auto refused = simulate(system, by(Method::fesd, 0.8));
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().message,
            "the system was built for e = 0.5: the restitution of 'ground' is 0.5, which does not hold for e = 0.8");
}

System thermostat() {
  Builder m("thermostat");
  const SX x = m.state("x", {18.0}), y = m.state("y", {0.0});
  const SX heating = m.hysteresis("heating", x, {.on = 19.0, .off = 21.0, .initial = 1.0});
  m.dynamics("x", 6 * heating - 2 - 0.1 * (x - 20));
  m.dynamics("y", heating);
  return made(m);
}

TEST(FrozenBuilderTest, Hysteresis) {
  const auto system = thermostat();
  const auto exact = end_of(system, by(Method::event, 4.0)), frozen = end_of(system, by(Method::fesd, 4.0));
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(frozen.x[i], exact.x[i], 1e-6) << "state " << i;
}

// The same room, heated with 10: however its hysteresis is compared.
TEST(FrozenBuilderTest, ComparedHysteresis) {
  using Rate = SX (*)(Builder&, const SX& heating, const SX& x);
  constexpr Rate rates[] = {
      [](Builder&, const SX& h, const SX&) { return SX(10 * h); },
      [](Builder& m, const SX& h, const SX&) { return m.if_(model::greater(h, 0.5), 10, 0); },
      [](Builder& m, const SX& h, const SX&) { return m.if_(model::equal(h, 1), 10, 0) + 0 * m.step(h); },
      [](Builder& m, const SX& h, const SX&) { return m.if_(model::not_equal(h, 0), 5, 0) + 5 * m.step(h - 0.5); },
      [](Builder& m, const SX& h, const SX& x) {
        return m.if_(model::less(x, m.if_(model::greater(h, 0), 100, 10)), 10, 0);
      }};
  for (const Rate rate : rates) {
    Builder m("room");
    const SX x = m.state("x", {15.0}), y = m.state("y", {0.0});
    const SX heating = m.hysteresis("heating", x, {.on = 18.0, .off = 20.0, .initial = 1.0});
    m.dynamics("x", rate(m, heating, x) - 0.5 * (x - 15));
    m.mode(model::equal(heating, 1), {{"y", 1}});
    m.otherwise({{"y", 0}});
    const auto system = made(m);
    const auto exact = end_of(system, by(Method::event, 3.0)), frozen = end_of(system, by(Method::fesd, 3.0));
    EXPECT_NEAR(exact.x.at(0), 19.0778725174, 1e-8);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(frozen.x.at(i), exact.x.at(i), 1e-6) << "state " << i;
  }
}

TEST(FrozenBuilderTest, NumbersAreChecked) {
  Builder numbers("numbers");
  numbers.time_freezing({.a_n = -1.0});
  const auto built = numbers.build();
  ASSERT_FALSE(built);
  EXPECT_EQ(built.error().message, "a_n is -1");
}

}  // namespace
}  // namespace saltus::pipeline
