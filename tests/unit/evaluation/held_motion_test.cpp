// The motion while the guards of accumulated jumps are held at 0.
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "saltus/evaluation/model_kernel.hpp"
#include "saltus/model/builder.hpp"

namespace saltus::evaluation {
namespace {

using casadi::SX;
using model::Builder;
using model::Direction;
using Point = std::vector<double>;

ModelKernel compiled(Builder& model) {
  auto system = model.build();
  EXPECT_TRUE(system.has_value()) << (system ? "" : to_text(system.error()));
  auto kernel = ModelKernel::compile(*system);
  EXPECT_TRUE(kernel.has_value());
  return std::move(*kernel);
}

std::vector<Hold> holds_of(const ModelKernel& kernel, const std::vector<int>& jumps) {
  std::vector<Hold> holds;
  for (const int jump : jumps) holds.push_back({jump, kernel.jump_guard(jump, 0)});
  return holds;
}

Point field(const ModelKernel& kernel, double t, const Point& x, const Point& alpha = {}) {
  Point xdot(x.size());
  kernel.field(t, x.data(), alpha.data(), xdot.data());
  return xdot;
}

Point pressure(const ModelKernel& kernel, std::size_t holds, double t, const Point& x, const Point& alpha = {}) {
  Point result(holds);
  kernel.hold_pressure(t, x.data(), alpha.data(), result.data());
  return result;
}

TEST(HeldMotion, ABallAtRestStaysOnTheGround) {
  Builder model("ball");
  const SX g = model.parameter("g", 9.81), e = model.parameter("e", 0.5);
  const SX y = model.state("y", {}), v = model.state("v", {}), x = model.state("x", {}), vx = model.state("vx", {});
  const SX n = model.discrete_state("n", 0.0), last = model.discrete_state("last", 0.0);
  model.dynamics("y", v);
  model.dynamics("v", -g);
  model.dynamics("x", vx);
  model.dynamics("vx", -vx);
  // Discrete states absorb nothing, also where their new values depend on the velocity.
  model.jump(y, Direction::down, {{"v", -e * v}, {"n", n + 1.0}, {"last", v}});
  ModelKernel kernel = compiled(model);
  const Point state{0.0, 0.0, 1.0, 2.0, 7.0, 3.0};
  EXPECT_EQ(field(kernel, 0.0, state)[1], -9.81);
  ASSERT_TRUE(kernel.hold(holds_of(kernel, {0})).has_value());
  EXPECT_EQ(field(kernel, 0.0, state), (Point{0.0, 0.0, 2.0, -2.0, 0.0, 0.0}));
  EXPECT_DOUBLE_EQ(pressure(kernel, 1, 0.0, state)[0], -9.81);
  EXPECT_EQ(kernel.lie_derivative(kernel.jump_guard(0, 0), 2, 0.0, state.data(), nullptr), 0.0);
  ASSERT_TRUE(kernel.hold({}).has_value());
  EXPECT_EQ(field(kernel, 0.0, state)[1], -9.81);
  EXPECT_EQ(kernel.lie_derivative(kernel.jump_guard(0, 0), 2, 0.0, state.data(), nullptr), -9.81);
}

TEST(HeldMotion, ABallOnAMovingTableFollowsItUntilThePressurePassesZero) {
  Builder model("table");
  const SX t = model.time(), y = model.state("y", {}), v = model.state("v", {});
  const double amplitude = 2.0, omega = 3.0;
  const SX table = amplitude * sin(omega * t);
  model.dynamics("y", v);
  model.dynamics("v", -9.81);
  model.jump(y - table, Direction::down, {{"v", -0.5 * v + 1.5 * amplitude * omega * cos(omega * t)}});
  ModelKernel kernel = compiled(model);
  ASSERT_TRUE(kernel.hold(holds_of(kernel, {0})).has_value());
  const double lift = std::asin(9.81 / (amplitude * omega * omega)) / omega;  // g = a omega^2 sin(omega t)
  for (const double time : {0.0, 0.1, lift, 0.4}) {
    const double acceleration = -amplitude * omega * omega * std::sin(omega * time);
    const Point state{amplitude * std::sin(omega * time), amplitude * omega * std::cos(omega * time)};
    EXPECT_NEAR(field(kernel, time, state)[1], acceleration, 1e-14 * 20);
    EXPECT_NEAR(pressure(kernel, 1, time, state)[0], -9.81 - acceleration, 1e-13);
  }
}

TEST(HeldMotion, OnASlopeOnlyTheNormalMotionIsHeld) {
  Builder model("slope");
  const SX x = model.state("x", {}), y = model.state("y", {}), vx = model.state("vx", {}), vy = model.state("vy", {});
  const double c = std::cos(0.3), s = std::sin(0.3);
  const SX normal = -s * vx + c * vy;
  model.dynamics("x", vx);
  model.dynamics("y", vy);
  model.dynamics("vx", 0.0 * x);
  model.dynamics("vy", -9.81);
  model.jump(-s * x + c * y, Direction::down, {{"vx", vx + 1.5 * s * normal}, {"vy", vy - 1.5 * c * normal}});
  ModelKernel kernel = compiled(model);
  ASSERT_TRUE(kernel.hold(holds_of(kernel, {0})).has_value());
  const Point xdot = field(kernel, 0.0, {c, s, -c, -s});
  EXPECT_NEAR(xdot[2], -9.81 * s * c, 1e-14);
  EXPECT_NEAR(xdot[3], -9.81 * s * s, 1e-14);
  EXPECT_NEAR(pressure(kernel, 1, 0.0, {c, s, -c, -s})[0], -9.81 * c, 1e-14);
}

/// Ball 1 on the ground, ball 2 on ball 1.
Builder two_balls(double m1, double m2, double e) {
  Builder model("two balls");
  const SX y1 = model.state("y1", {}), v1 = model.state("v1", {}), y2 = model.state("y2", {}),
           v2 = model.state("v2", {});
  const SX exchange = (1.0 + e) * (v2 - v1) / (m1 + m2);
  model.dynamics("y1", v1);
  model.dynamics("v1", -9.81);
  model.dynamics("y2", v2);
  model.dynamics("v2", -9.81);
  model.jump(y1, Direction::down, {{"v1", -e * v1}});
  model.jump(y2 - y1, Direction::down, {{"v1", v1 + m2 * exchange}, {"v2", v2 - m1 * exchange}});
  return model;
}

TEST(HeldMotion, TwoBallsRestOnEachOther) {
  const double m1 = 2.0, m2 = 3.0;
  Builder model = two_balls(m1, m2, 0.5);
  ModelKernel kernel = compiled(model);
  const Point state{0.0, 0.0, 0.0, 0.0};
  ASSERT_TRUE(kernel.hold(holds_of(kernel, {0, 1})).has_value());
  for (const double rate : field(kernel, 0.0, state)) EXPECT_NEAR(rate, 0.0, 1e-14);
  // The ground carries both weights: -(m1 + m2) g / m1; the reduced mass carries the upper one.
  const Point both = pressure(kernel, 2, 0.0, state);
  EXPECT_NEAR(both[0], -9.81 * (m1 + m2) / m1, 1e-13);
  EXPECT_NEAR(both[1], -9.81 * (m1 + m2) / m1, 1e-13);
  ASSERT_TRUE(kernel.hold(holds_of(kernel, {1})).has_value());  // both fall together and do not press
  EXPECT_NEAR(field(kernel, 0.0, state)[1], -9.81, 1e-14);
  EXPECT_NEAR(field(kernel, 0.0, state)[3], -9.81, 1e-14);
  EXPECT_NEAR(pressure(kernel, 1, 0.0, state)[0], 0.0, 1e-14);
  ASSERT_TRUE(kernel.hold(holds_of(kernel, {0, 1})).has_value());  // again, from what is compiled
  EXPECT_EQ(pressure(kernel, 2, 0.0, state), both);
}

TEST(HeldMotion, AgreesWithItsDefinitionByFiniteDifferences) {
  Builder model("curved");
  const SX t = model.time(), a = model.state("a", {}), b = model.state("b", {}), c = model.state("c", {});
  const SX load = model.control("load", {});
  model.input("load", 2.0 * cos(t));
  model.dynamics("a", sin(b) + c * c + 0.1 * t);
  model.dynamics("b", -a * b + load + model.sign(c - 5.0, "slip"));
  model.dynamics("c", exp(-a) - c + load);
  model.jump(a * a - 0.3 * cos(t), Direction::down, {{"b", -0.7 * b + a * c}, {"c", 0.4 * c - sin(b)}});
  ModelKernel kernel = compiled(model);
  const int guard = kernel.jump_guard(0, 0);
  const double time = 0.4, h = 1e-5;
  const Point x{0.6, -0.4, 0.9}, alpha{0.25};
  const auto rate_of_guard = [&](const Point& at) {
    return kernel.lie_derivative(guard, 1, time, at.data(), alpha.data());
  };
  const auto shifted = [&](std::size_t i, double by) {
    Point at = x;
    at[i] += by;
    return at;
  };
  Point normal(3), direction(3, 0.0);
  double change[2][3];
  for (std::size_t i = 0; i < 3; ++i) {
    normal[i] = (rate_of_guard(shifted(i, h)) - rate_of_guard(shifted(i, -h))) / (2.0 * h);
    double above[2], below[2];
    kernel.jump_values(0, time, shifted(i, h).data(), alpha.data(), above);
    kernel.jump_values(0, time, shifted(i, -h).data(), alpha.data(), below);
    for (const std::size_t k : {0U, 1U}) change[k][i] = (above[k] - below[k]) / (2.0 * h) - (i == k + 1 ? 1.0 : 0.0);
  }
  for (const std::size_t k : {0U, 1U}) direction[k + 1] = change[k][1] * normal[1] + change[k][2] * normal[2];
  const double matrix = normal[1] * direction[1] + normal[2] * direction[2];
  const double second = kernel.lie_derivative(guard, 2, time, x.data(), alpha.data());
  const Point free = field(kernel, time, x, alpha);
  ASSERT_TRUE(kernel.hold(holds_of(kernel, {0})).has_value());
  const Point held = field(kernel, time, x, alpha);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(held[i], free[i] - direction[i] * second / matrix, 1e-7) << i;
  EXPECT_NEAR(kernel.lie_derivative(guard, 2, time, x.data(), alpha.data()), 0.0, 1e-12);
  EXPECT_NEAR(pressure(kernel, 1, time, x, alpha)[0], second, 1e-12);
  EXPECT_TRUE(kernel.depends(0, 0));  // slip's normal component, c', has the alpha of b' in it only while held
  ASSERT_TRUE(kernel.hold({}).has_value());
  EXPECT_FALSE(kernel.depends(0, 0));
}

TEST(HeldMotion, StatesThatCannotHoldTheGuardAreRefused) {
  Builder fire("integrate and fire");
  const SX v = fire.state("v", {});
  fire.dynamics("v", 2.0 - v);
  fire.jump(v - 1.0, Direction::up, {{"v", 0.0}}, {.name = "spike"});
  ModelKernel firing = compiled(fire);
  const auto direct = firing.hold(holds_of(firing, {0}));
  ASSERT_FALSE(direct.has_value());
  EXPECT_NE(direct.error().message.find("'spike'"), std::string::npos) << direct.error().message;
  EXPECT_EQ(field(firing, 0.0, {0.5})[0], 1.5) << "the motion is as it was";

  Builder other("sets another state");
  const SX y = other.state("y", {}), w = other.state("w", {}), z = other.state("z", {});
  other.dynamics("y", w);
  other.dynamics("w", -1.0);
  other.dynamics("z", 1.0);
  other.jump(y, Direction::down, {{"z", -z}}, {.name = "elsewhere"});
  other.jump(y, Direction::down, {{"w", w}}, {.name = "nothing"});
  other.jump(y, Direction::down, {{"w", -0.5 * w}}, {.name = "once"});
  other.jump(2.0 * y, Direction::down, {{"w", -w}}, {.name = "twice"});
  ModelKernel kernel = compiled(other);
  EXPECT_NE(kernel.hold(holds_of(kernel, {0})).error().message.find("'elsewhere'"), std::string::npos);
  EXPECT_NE(kernel.hold(holds_of(kernel, {1})).error().message.find("'nothing'"), std::string::npos);
  EXPECT_TRUE(kernel.hold(holds_of(kernel, {2})).has_value());
}

}  // namespace
}  // namespace saltus::evaluation
