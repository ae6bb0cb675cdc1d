// Optima beside points at which a contact stops, sticks or collides exactly where an interval ends, and a coarse grid.
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "ocp_models.hpp"

namespace saltus::ocp_tests {
namespace {

using result::Termination;

/// A ball that rises until t = 2: its rate may change its sign before the horizon ends. The problem is a quadratic one
/// in the two controls; with v(2) = 0 J = 0.863176.
TEST(OcpIntervalEnds, ARateMayChangeItsSignWhereTheHorizonEnds) {
  const auto result = optimized(stated(R"toml(
[model]
name = "rising"
[states]
x = 0.201
v = 0.233
[controls]
u = { lower = -8, upper = 8 }
[mechanics]
positions = ["x"]
velocities = ["v"]
force = { v = "u - 3" }
[[contacts]]
name = "ground"
gap = "x"
restitution = 0
[optimize]
horizon = 2
control_intervals = 2
running_cost = "0.05*u^2"
terminal_cost = "10*(x - 1)^2 + 0.5*v^2"
stages = 2
reformulation = "stewart"
)toml"));
  EXPECT_EQ(result.status.termination, Termination::completed) << result.status.message;
  EXPECT_NEAR(result.optimization->objective, 0.8507274, 1e-6);
}

/// The least J of a block that slides, sticks and is pushed again, by the closed form of its motion.
void expect_block(double mass, double friction, double horizon, const std::string& rest, double optimum) {
  const auto result = optimized(stated(fmt::format(R"toml(
[model]
name = "block"
[states]
x = 0
v = 1
z = 0
vz = 0
[controls]
u = {{ lower = -3, upper = 3 }}
[mechanics]
positions = ["x", "z"]
velocities = ["v", "vz"]
mass = [["{0}", "0"], ["0", "1"]]
force = {{ v = "u", vz = "-{0}" }}
[[contacts]]
name = "table"
gap = "z"
tangent = {{ x = 1 }}
friction = {1}
[optimize]
horizon = {2}
control_intervals = 2
running_cost = "0.05*u^2"
stages = 2
{3}
)toml",
                                                   mass, friction, horizon, rest)));
  EXPECT_EQ(result.status.termination, Termination::completed) << result.status.message;
  EXPECT_NEAR(result.optimization->objective, optimum, 1e-6);
}

/// J = 0.2284 where the block stops exactly at the end of the first interval, and does not stick before.
TEST(OcpIntervalEnds, BlocksStopBeforeAnIntervalEnds) {
  expect_block(2, 0.649, 2, "terminal_cost = \"10*(x - 0.3)^2\"\n", 0.2048667);
}

/// J = 0.0974 where the block rests at the edge of stick, and does not go back.
TEST(OcpIntervalEnds, BlocksAreNotHeldAtTheEdgeOfStick) {
  expect_block(1, 0.458, 3, "terminal_cost = \"10*(x - 0.3)^2 + 0.5*v^2\"\nreformulation = \"stewart\"\n", 0.0442437);
}

/// A ball that lands exactly where the horizon ends, with J = 0.2406; before, it rests for a while. With three elements
/// a flight, the impact and the rest are as long as they may be, and a warning says so.
TEST(OcpIntervalEnds, ABallLandsBeforeTheHorizonEnds) {
  for (const bool is_fine : {false, true}) {
    const Stated problem = stated(R"toml(
[model]
name = "landing"
[states]
x = 0.576
v = 0.599
[controls]
u = { lower = -8, upper = 8 }
[mechanics]
positions = ["x"]
velocities = ["v"]
mass = [["2"]]
force = { v = "u - 2" }
[[contacts]]
name = "ground"
gap = "x"
restitution = 0
[optimize]
horizon = 2
control_intervals = 2
running_cost = "0.1*u^2 + 0.3*v^2"
terminal_cost = "10*(x - 0.05)^2 + 2*v^2"
stages = 2
reformulation = "stewart"
)toml" + std::string(is_fine ? "elements = 4\n" : ""));
    std::string warnings;
    pipeline::OptimizeObservers observers;
    observers.on_warning = [&](const std::string& warning) { warnings += warning; };
    const auto result = pipeline::optimize(problem.ocp, problem.options, observers);
    ASSERT_TRUE(result);
    EXPECT_EQ(result->status.termination, Termination::completed) << result->status.message;
    EXPECT_NEAR(result->optimization->objective, is_fine ? 0.2277304 : 0.2329771, 1e-6);
    EXPECT_EQ(warnings.find("elements = 4") != std::string::npos, !is_fine) << warnings;
    EXPECT_EQ(result->status.message, warnings);
  }
}

TEST(OcpIntervalEnds, ACoarseGridSaysWhatToWrite) {
  const auto result = optimized(stated(R"toml(
[model]
name = "drag"
[states]
q = 0
v = 0
[controls]
u = { lower = -2, upper = 2 }
[dynamics]
q = "v"
v = "u - 0.5*sign(v) - v*abs(v)"
[optimize]
horizon = 2
control_intervals = 5
running_cost = "u^2"
terminal_constraints = ["q == 0.5", "v == 0"]
stages = 1
)toml"));
  EXPECT_EQ(result.status.termination, Termination::verification_failed);
  for (const auto* key : {"stages = 2", "elements = 5", "control_intervals = 10"}) {
    EXPECT_NE(result.status.message.find(key), std::string::npos) << result.status.message;
  }
}

}  // namespace
}  // namespace saltus::ocp_tests
