// The same problem in C++ and as a text.
#include <utility>

#include <gtest/gtest.h>

#include "ocp_models.hpp"
#include "saltus/model/optimal_control/ocp_builder.hpp"

namespace saltus::ocp_tests {
namespace {

using casadi::SX;
using model::OcpBuilder;

struct Car {
  model::Builder builder{"turbo-car"};
  SX q = builder.state("q", {0.0});
  SX v = builder.state("v", {0.0, -20.0, 20.0});
  SX u = builder.control("u", {0.0, -5.0, 5.0});

  Car() {
    builder.dynamics("q", v);
    builder.dynamics("v", builder.if_(model::greater(v, 10), 3, 1) * u);
  }
};

OcpBuilder turbo() {
  Car car;
  OcpBuilder problem(std::move(car.builder));
  problem.free_horizon(10, 1, 100);
  problem.minimize_time();
  problem.terminal_constraint("q == 200", 200, car.q, 200);
  problem.terminal_constraint("v == 0", 0, car.v, 0);
  return problem;
}

TEST(OcpBuilder, StatesTheTurboCar) {
  auto ocp = turbo().build();
  ASSERT_TRUE(ocp) << to_text(ocp.error());
  auto text = stated(turbo_car(20, 10));
  const auto result = optimized({std::move(*ocp), text.options});
  const auto same = optimized(text);
  EXPECT_EQ(result.status.termination, result::Termination::completed) << result.status.message;
  EXPECT_EQ(result.optimization->objective, same.optimization->objective);
  EXPECT_NEAR(result.optimization->objective, 40.0 / 3.0, 1e-9);
}

TEST(OcpBuilder, CostsGuessesAndWhatIsFree) {
  model::Builder builder("slope");
  const SX a = builder.parameter("a", 0.5), x = builder.state("x", {0.2, -1, 1}),
           u = builder.control("u", {0.0, -3, 3});
  builder.dynamics("x", a * u);
  OcpBuilder problem(std::move(builder));
  problem.horizon(1);
  problem.start_time(2);
  problem.free_state("x");
  problem.free_parameter("a", 0.1, 2);
  problem.guess("u", SX(1));
  problem.running_cost(u * u);
  problem.least_squares({a - 1}, {}, {}, model::CostPoints::end);
  problem.terminal_constraint("x >= 1", 1, x, 1);
  auto ocp = problem.build();
  ASSERT_TRUE(ocp) << to_text(ocp.error());
  pipeline::OptimizeOptions options;
  options.control_intervals = 2;
  const auto result = optimized({std::move(*ocp), options});
  EXPECT_EQ(result.status.termination, result::Termination::completed) << result.status.message;
  EXPECT_NEAR(result.optimization->objective, 0.0, 1e-9);
  EXPECT_NEAR(result.optimization->nodes.front()[0], 1.0, 1e-5);
}

TEST(OcpBuilder, FreezesContacts) {
  model::Builder builder("landing");
  const SX z = builder.state("z", {1.0}), v = builder.state("v", {0.0}), u = builder.control("u", {0.0, -10, 10});
  builder.mechanics({.positions = {"z"}, .velocities = {"v"}, .potential = 9.81 * z, .force = {{"v", u}}});
  builder.contact("ground", z);
  builder.time_freezing({.a_n = 9.81});
  OcpBuilder problem(std::move(builder));
  problem.horizon(1);
  problem.running_cost(u * u);
  problem.terminal_constraint("z == 0", 0, z, 0);
  problem.terminal_constraint("v == 0", 0, v, 0);
  auto ocp = problem.build();
  ASSERT_TRUE(ocp) << to_text(ocp.error());
  auto text = stated(R"toml(
[model]
name = "landing"
[states]
z = 1
v = 0
[controls]
u = { lower = -10, upper = 10 }
[mechanics]
positions = ["z"]
velocities = ["v"]
potential = "9.81*z"
force = { v = "u" }
[[contacts]]
name = "ground"
gap = "z"
[time_freezing]
a_n = 9.81
[optimize]
horizon = 1
control_intervals = 3
stages = 2
running_cost = "u^2"
terminal_constraints = ["z == 0", "v == 0"]
)toml");
  const auto result = optimized({std::move(*ocp), text.options}), same = optimized(text);
  EXPECT_EQ(result.status.termination, result::Termination::completed) << result.status.message;
  EXPECT_NEAR(result.optimization->objective, same.optimization->objective, 1e-6);
  EXPECT_EQ(result.outputs, same.outputs);
}

/// The turbo works from 15 on until the car is slower than 10.
TEST(OcpBuilder, FreezesHysteresis) {
  model::Builder builder("turbo");
  const SX q = builder.state("q", {0.0}), v = builder.state("v", {0.0, 0, 25}), u = builder.control("u", {4.0, -5, 5});
  const SX turbo = builder.hysteresis("turbo", v, {.on = 15, .off = 10});
  builder.dynamics("q", v);
  builder.dynamics("v", u * (1 + 2 * turbo));
  builder.time_freezing({.speed_lower = 0.1});
  OcpBuilder problem(std::move(builder));
  problem.free_horizon(10.5, 1, 50);
  problem.minimize_time();
  problem.terminal_constraint("q == 150", 150, q, 150);
  problem.terminal_constraint("v == 0", 0, v, 0);
  auto ocp = problem.build();
  ASSERT_TRUE(ocp) << to_text(ocp.error());
  EXPECT_EQ(ocp->system.state_names, (std::vector<std::string>{"q", "v", "turbo", "frozen.clock"}));
  EXPECT_EQ(ocp->physical->state_names, (std::vector<std::string>{"q", "v", "turbo"}));
  EXPECT_EQ(ocp->clock->state, 3);
  EXPECT_EQ(ocp->clock->speed_lower, 0.1);
}

/// Outputs of mechanics are behind those of the problem.
TEST(OcpBuilder, TakesMechanics) {
  model::Builder builder("cart");
  const SX x = builder.state("x", {0.0}), v = builder.state("v", {0.0}), u = builder.control("u", {0.0, -5, 5});
  builder.mechanics({.positions = {"x"}, .velocities = {"v"}, .force = {{"v", u}}});
  OcpBuilder problem(std::move(builder));
  problem.horizon(1);
  problem.running_cost(u * u);
  problem.terminal_constraint("x == 1/4", 0.25, x, 0.25);
  auto ocp = problem.build();
  ASSERT_TRUE(ocp) << to_text(ocp.error());
  pipeline::OptimizeOptions options;
  options.control_intervals = 4;
  const auto result = optimized({std::move(*ocp), options});
  EXPECT_EQ(result.status.termination, result::Termination::completed) << result.status.message;
  // u_k = c (T - t_k - h/2): c = x(T) / sum h (T - t_k - h/2)^2, f = c x(T).
  EXPECT_NEAR(result.optimization->objective,
              0.0625 / (0.25 * (0.875 * 0.875 + 0.625 * 0.625 + 0.375 * 0.375 + 0.125 * 0.125)), 1e-7);
}

TEST(OcpBuilder, KeepsTheFirstMistake) {
  const auto message = [](OcpBuilder problem) {
    auto ocp = problem.build();
    return ocp ? std::string() : to_text(ocp.error());
  };
  auto problem = turbo();
  problem.free_state("w");
  EXPECT_NE(message(std::move(problem)).find("expected the name of a state, found 'w'"), std::string::npos);
  problem = turbo();
  problem.free_horizon(10, 20, 30);
  EXPECT_NE(message(std::move(problem)).find("the horizon begins at 10, outside of its bounds"), std::string::npos);
  Car car;
  OcpBuilder squares(std::move(car.builder));
  squares.horizon(1);
  squares.least_squares({car.q, car.v}, {}, linalg::Matrix::identity(3, 3));
  EXPECT_NE(message(std::move(squares)).find("3 x 3 for 2 expressions"), std::string::npos);
}

}  // namespace
}  // namespace saltus::ocp_tests
