// Optima that are known exactly.
#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "ocp_models.hpp"

namespace saltus::ocp_tests {
namespace {

using result::Termination;

TEST(OcpOptima, StewartAnitescuFromFiftyStarts) {
  // By quadrature: V(x0) = -x0^3/9 + (2 + x0/3)^3/3 + (1/3 + x0/3)^2.
  constexpr double x0 = -1.427572232082767;
  constexpr double optimum = 1.523772775374957;
  Stated problem = stated(stewart_anitescu("elements = 25\ncross_complementarity = \"fe_stage\"\n"));
  for (int i = 0; i < 50; ++i) {
    problem.ocp.system.initial_state[0] = -2.0 + 1.2 * i / 49.0;
    const auto result = optimized(problem);
    ASSERT_EQ(result.status.termination, Termination::completed) << i << ": " << result.status.message;
    EXPECT_NEAR(result.optimization->objective, optimum, 1e-9) << i;
    EXPECT_NEAR(result.optimization->nodes.front()[0], x0, 1e-9) << i;
  }
}

/// To do nothing is an optimum, too, of J = 108: from open selections of dry friction nothing else is found.
TEST(OcpOptima, APendulumWithDryFrictionSwingsUp) {
  const auto result = optimized(stated(R"toml(
[model]
name = "swing-up"
[states]
th = 3.141592653589793
w = 0
[controls]
u = { lower = -4, upper = 4 }
[dynamics]
th = "w"
w = "9.81*sin(th) + u - 0.6*sign(w)"
[optimize]
horizon = 4
control_intervals = 20
elements = 2
running_cost = "0.1*u^2 + (1 - cos(th)) + 0.05*w^2"
terminal_cost = "50*(1 - cos(th)) + 5*w^2"
)toml"));
  EXPECT_EQ(result.status.termination, Termination::completed) << result.status.message;
  EXPECT_LT(result.optimization->objective, 9.79);
}

/// With nine intervals an impact at the end of the fifth one: found from the motion of the guessed controls, which
/// costs as much as any other start. From the first start alone T = 0.8978.
TEST(OcpOptima, ABlockBouncesOffAWallAndSlidesBackInLeastTime) {
  const auto result = optimized(stated(R"toml(
[model]
name = "wall-bounce"
[states]
x = 0
v = 0
[controls]
F = { initial = 10, lower = 0, upper = 20 }
[mechanics]
positions = ["x"]
velocities = ["v"]
force = { v = "F - 0.6*9.81*sign(v)" }
[[contacts]]
name = "wall"
gap = "1 - x"
restitution = 0.8
[optimize]
horizon = { free = true, initial = 1, lower = 0.2, upper = 3 }
control_intervals = 9
minimize_time = true
terminal_constraints = ["x == 0", "v <= -2"]
)toml"));
  EXPECT_EQ(result.status.termination, Termination::completed) << result.status.message;
  EXPECT_NEAR(result.optimization->objective, 0.67758, 1e-4);
}

/// Every element in which the state crosses is a false optimum. Where little is smoothed, the start decides in which
/// one it ends; strong smoothing leads to one and the same, which is wrong by the order of the steps, too.
TEST(OcpOptima, StewartAnitescuWithoutSwitchDetectionStopsAtFalseOptima) {
  constexpr double optimum = 1.523772775374957;
  Stated problem = stated(stewart_anitescu("elements = 25\nswitch_detection = false\nverification_tolerance = 1\n"));
  for (const bool is_smoothed : {false, true}) {
    problem.options.mpcc.strategy = solver::Strategy::ipopt;
    problem.options.mpcc.sigma_initial = is_smoothed ? 1.0 : 1e-3;
    double smallest = 10.0;
    double largest = 0.0;
    for (const double start : {-1.9, -1.6, -1.3, -1.0}) {
      problem.ocp.system.initial_state[0] = start;
      const auto result = optimized(problem);
      EXPECT_EQ(result.status.termination, Termination::completed) << result.status.message;
      smallest = std::min(smallest, result.optimization->objective);
      largest = std::max(largest, result.optimization->objective);
      EXPECT_GT(std::abs(result.optimization->objective - optimum), 0.01) << start;
    }
    EXPECT_EQ(largest - smallest > 0.05, !is_smoothed);
    EXPECT_EQ(largest - smallest < 1e-9, is_smoothed);
  }
}

/// x slides at 0 until t = 1 and leaves tangentially: x(1.5) = 1/8, whatever the control. An optimiser that may choose
/// where sliding ends leaves early, and finds 0.12 with a defect of 4 %.
TEST(OcpOptima, SlidingEndsWhereItHasTo) {
  for (const std::string form :
       {"scheme = \"radau_iia\"", "scheme = \"gauss_legendre\"", "reformulation = \"stewart\""}) {
    const auto result = optimized(stated(R"toml(
[model]
name = "leaving"
[states]
x = 0
[controls]
u = { lower = -1, upper = 1 }
[dynamics]
x = "t - sign(x)"
[optimize]
horizon = 1.5
control_intervals = 1
running_cost = "u^2"
terminal_cost = "x"
)toml" + form));
    EXPECT_EQ(result.status.termination, Termination::completed) << form << ": " << result.status.message;
    EXPECT_NEAR(result.optimization->objective, 0.125, 1e-10) << form;
    ASSERT_TRUE(result.optimization->verification) << form;
    EXPECT_LT(result.optimization->verification->interval_defect, 1e-10) << form;
  }
}

/// Beyond the shore x is drawn away. The best controls touch it, and between two stages they are beyond it: the motion
/// of an optimum that is only asked at stages (0.00635) is another one, and ends off by 0.76 of its range.
TEST(OcpOptima, SurfacesThatAreOnlyTouchedAreKeptOff) {
  for (const std::string form : {"", "reformulation = \"stewart\"\n"}) {
    const auto result = optimized(stated(R"toml(
[model]
name = "shore"
[states]
x = 0.5
y = 0
[controls]
u = { lower = -3, upper = 3 }
[dynamics]
x = "u + 2*(t - 1) + 2*(sign(x) - 1)"
y = "sign(x)"
[optimize]
horizon = 2
control_intervals = 4
elements = 4
running_cost = "(x - 0.5*(t - 1)^2 + 0.02)^2 + 0.01*u^2"
)toml" + form));
    EXPECT_EQ(result.status.termination, Termination::completed) << form << ": " << result.status.message;
    EXPECT_NEAR(result.optimization->objective, 0.00637, 5e-5) << form;
    ASSERT_TRUE(result.optimization->verification) << form;
    EXPECT_LT(result.optimization->verification->interval_defect, 1e-10) << form;
    EXPECT_EQ(result.optimization->verification->switches_missed, 0) << form;
  }
}

/// A ball that comes nowhere near the ground: the rate of its gap says nothing, so that it may change its sign. By
/// quadrature J = 1.0403050; an optimiser that holds the rate at 0 hovers, with J = 1.4224.
TEST(OcpOptima, RatesOfOpenGapsAreNotHeld) {
  for (const std::string form :
       {"stages = 2\n", "stages = 2\nreformulation = \"stewart\"\n", "stages = 2\nelements = 4\n",
        "stages = 3\nreformulation = \"stewart\"\n", "stages = 4\nreformulation = \"stewart\"\n"}) {
    const auto result = optimized(stated(R"toml(
[model]
name = "flying"
[states]
x = 0.3
v = 0
[controls]
u = { lower = -15, upper = 15 }
[mechanics]
positions = ["x"]
velocities = ["v"]
force = { v = "u - 9.81" }
[[contacts]]
name = "ground"
gap = "x"
restitution = 0
[optimize]
horizon = 1
control_intervals = 2
running_cost = "0.01*u^2 + (x - 0.2)^2"
terminal_cost = "5*(x - 0.6)^2 + v^2"
)toml" + form));
    EXPECT_EQ(result.status.termination, Termination::completed) << form << ": " << result.status.message;
    EXPECT_NEAR(result.optimization->objective, 1.0403050, 1e-4) << form;
    EXPECT_NEAR(result.optimization->u[0][0], 10.90247, 1e-3) << form;
    EXPECT_NEAR(result.optimization->u[1][0], 8.61512, 1e-3) << form;
  }
}

/// A mass at rest: |v| v does not depend on which side of v = 0 it is. With SciPy J = 0.0473970; held at rest
/// 0.0498775.
TEST(OcpOptima, KinksAreNotHeld) {
  const auto result = optimized(stated(R"toml(
[model]
name = "kink"
[states]
x = -0.08319974571377575
v = 0
[controls]
u = { lower = -2, upper = 2 }
[dynamics]
x = "v"
v = "u - 2*max(x, 0) - 0.5*abs(v)*v"
[optimize]
horizon = 3
control_intervals = 3
running_cost = "0.1*u^2"
terminal_cost = "3*(x - 0.5)^2 + v^2"
stages = 2
reformulation = "stewart"
scheme = "gauss_legendre"
)toml"));
  EXPECT_EQ(result.status.termination, Termination::completed) << result.status.message;
  EXPECT_NEAR(result.optimization->objective, 0.0473970, 2e-5);
}

/// A pusher that brakes until it only touches another body has an infinite slope towards a soft impact.
TEST(OcpOptima, TouchingIsNoOptimumBesideAnImpact) {
  const auto result = optimized(stated(R"toml(
[model]
name = "touching"
[states]
x1 = 0
x2 = 0.3
v1 = 0.5
v2 = 0
[controls]
u = { lower = -4, upper = 4 }
[mechanics]
positions = ["x1", "x2"]
velocities = ["v1", "v2"]
force = { v1 = "u", v2 = "-0.319*v2" }
[[contacts]]
name = "c"
gap = "x2 - x1 - 0.2"
[optimize]
horizon = 2
control_intervals = 2
running_cost = "0.02*u^2"
terminal_cost = "5*(x2 - 1)^2 + x1^2"
elements = 4
stages = 2
reformulation = "stewart"
scheme = "gauss_legendre"
)toml"));
  EXPECT_EQ(result.status.termination, Termination::completed) << result.status.message;
  EXPECT_LT(result.optimization->objective, 0.70);  // 2.74 where it touches
}

/// The input of a hysteresis comes to its threshold at t = 1.5 and is held there, with J = 1.349. Any more of u
/// switches it, with J = 0.195 or less.
TEST(OcpOptima, HysteresisIsNotHeldAtItsThreshold) {
  const auto result = optimized(stated(R"toml(
[model]
name = "threshold"
[states]
x = 0.013106803383659299
[controls]
u = { lower = -1.5, upper = 1.5 }
[dynamics]
x = "-x + 0.821*hy + u"
[[hysteresis]]
name = "hy"
input = "x"
on = 0.5
off = 0.1
[optimize]
horizon = 3
control_intervals = 2
running_cost = "0.1*u^2"
terminal_cost = "5*(x - 1)^2"
stages = 4
reformulation = "stewart"
)toml"));
  EXPECT_EQ(result.status.termination, Termination::completed) << result.status.message;
  EXPECT_LT(result.optimization->objective, 0.195);
}

/// A thermostat that heats below 0.8 and until 1.2: relaxed problems alone end at 0.0388, and without a solution
/// over the shorter horizon.
TEST(OcpOptima, AThermostatIsLedPastItsThresholds) {
  const auto text = [](double horizon, const char* end) {
    return fmt::format(R"toml(
[model]
name = "oven"
[states]
T = 0
[controls]
fan = {{ lower = 0, upper = 1 }}
[dynamics]
T = "2*heat - T - fan"
[[hysteresis]]
name = "heat"
input = "T"
on = 0.8
off = 1.2
initial = 1
[optimize]
horizon = {}
control_intervals = 6
elements = 4
running_cost = "fan^2"
terminal_constraints = ["{}"]
)toml",
                       horizon, end);
  };
  const auto least = optimized(stated(text(3.0, "T == 0.9")));
  EXPECT_EQ(least.status.termination, result::Termination::completed) << least.status.message;
  EXPECT_LT(least.optimization->objective, 0.0049);
  const auto short_one = optimized(stated(text(1.6, "T == 0.9")));
  EXPECT_EQ(short_one.status.termination, result::Termination::completed) << short_one.status.message;
  EXPECT_LT(short_one.optimization->objective, 1.07);
}

/// x and y come to 0 at one time, and stay there. One after the other is better, best without control; three elements
/// have room for less of that (J = 4.6237113), as y may not come to 0 before a third of the interval, and get a fourth.
TEST(OcpOptima, SignsThatChangeTogetherAreTakenApart) {
  for (const int elements : {3, 4}) {
    const auto result = optimized(stated(R"toml(
[model]
name = "together"
[states]
x = -0.10580160715591802
y = -0.1893883973052961
[controls]
u = { lower = -3, upper = 3 }
[dynamics]
x = "u - 1.928*sign(x) - 0.290*sign(y)"
y = "0.5*u - 1.482*sign(y) + 0.098*x"
[optimize]
horizon = 2
control_intervals = 2
running_cost = "0.1*u^2"
terminal_cost = "5*(x + 0.069)^2 + 5*(y - 0.924)^2"
stages = 4
reformulation = "stewart"
elements = )toml" + std::to_string(elements) +
                                         "\n"));
    EXPECT_EQ(result.status.termination, Termination::completed) << elements << ": " << result.status.message;
    EXPECT_NEAR(result.optimization->objective, 4.292685, 1e-6) << elements;
  }
}

TEST(OcpOptima, TurboCar) {
  const auto result = optimized(stated(turbo_car(20, 10)));
  EXPECT_EQ(result.status.termination, Termination::completed) << result.status.message;
  EXPECT_NEAR(result.optimization->objective, 40.0 / 3.0, 1e-8);
  ASSERT_TRUE(result.optimization->verification);
  EXPECT_LT(result.optimization->verification->interval_defect, 1e-9);
}

TEST(OcpOptima, TurboCarOnGrids) {
  // Programs for the switching times of the exact flow.
  for (const auto& [intervals, optimum] :
       {std::pair{10, 12.0165871}, std::pair{20, 11.8151023}, std::pair{40, 11.8071442}}) {
    const auto result = optimized(stated(turbo_car(25, intervals)));
    EXPECT_EQ(result.status.termination, Termination::completed) << result.status.message;
    EXPECT_NEAR(result.optimization->objective, optimum, 1e-6 * optimum);
  }
}

}  // namespace
}  // namespace saltus::ocp_tests
