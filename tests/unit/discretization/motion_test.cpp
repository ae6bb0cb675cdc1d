// The motion of controls on the elements of a problem: its equations hold, and elements end where it switches.
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "saltus/adapters/ipopt/ipopt_solver.hpp"
#include "saltus/solver/certificate/classify.hpp"
#include "saltus/solver/crossover/branch.hpp"
#include "stated_problem.hpp"

namespace saltus::discretization {
namespace {

bool never() { return false; }

std::string sliding_block(int elements) {
  return R"toml(
[model]
name = "block"
[states]
q = 0
v = 1
[controls]
u = { lower = -8, upper = 8, initial = 0 }
[dynamics]
q = "v"
v = "u - sign(v)"
[optimize]
horizon = 2.4
control_intervals = 4
running_cost = "u^2"
elements = )toml" +
         std::to_string(elements) + "\n";
}

constexpr const char* bouncing_ball = R"toml(
[model]
name = "ball"
[states]
z = 0.8
vz = 0
[controls]
u = { lower = -1, upper = 1, initial = 0 }
[mechanics]
positions = ["z"]
velocities = ["vz"]
force = { vz = "u - 9.81" }
[[contacts]]
name = "ground"
gap = "z"
restitution = 0.75
[time_freezing]
a_n = 30
[optimize]
horizon = 1
control_intervals = 5
elements = 5
stages = 2
running_cost = "u^2"
)toml";

void expect_feasible(OcpProblem& problem, const linalg::Vector& w) {
  EXPECT_LE(solver::certificate::scaled_infeasibility(problem, w), 1e-8);
  EXPECT_LE(solver::certificate::complementarity(problem, w), 1e-8);
}

/// Friction stops the block at t = 1 and q = 1/2, within an interval; Radau's method is exact there.
TEST(Motion, ABlockThatStopsWithinAnIntervalStays) {
  const auto stated = stated_problem(sliding_block(2));
  auto& problem = *stated.problem;
  const auto motion = problem.motion(problem.start(), never);
  ASSERT_TRUE(motion);
  expect_feasible(problem, motion->w);
  const auto solution = problem.read(motion->w);
  EXPECT_NEAR(solution.elements.back().back().end[0], 0.5, 1e-9);
  EXPECT_NEAR(solution.elements[1].front().h, 0.4, 1e-7);
}

TEST(Motion, NeedsAnElementForEachMode) {
  const auto stated = stated_problem(sliding_block(1));
  EXPECT_FALSE(stated.problem->motion(stated.problem->start(), never));
}

/// Ten blocks at rest that are pushed together.
std::string pushed_blocks(double force) {
  std::string states, dynamics;
  for (int i = 0; i < 10; ++i) {
    const auto v = "v" + std::to_string(i);
    states += v + " = 0\n";
    dynamics += v + " = \"u - sign(" + v + ")\"\n";
  }
  return "[model]\nname = \"blocks\"\n[states]\n" + states +
         "[controls]\nu = { lower = -8, upper = 8, initial = " + std::to_string(force) + " }\n[dynamics]\n" + dynamics +
         "[optimize]\nhorizon = 1\ncontrol_intervals = 2\nrunning_cost = \"u^2\"\n";
}

/// Of 3^10 modes those that differ least are tried: all stick, or one or two do not.
TEST(Motion, OfManySurfacesReachedAtOnceFewMayBeLeft) {
  const auto held = stated_problem(pushed_blocks(0.5)), pushed = stated_problem(pushed_blocks(2.0));
  const auto motion = held.problem->motion(held.problem->start(), never);
  ASSERT_TRUE(motion);
  expect_feasible(*held.problem, motion->w);
  EXPECT_FALSE(pushed.problem->motion(pushed.problem->start(), never));
}

/// Its input comes to the threshold within the first interval; regions by indicators have no surfaces.
TEST(Motion, GoesThroughTheThresholdOfAHysteresis) {
  const auto stated = stated_problem(R"toml(
[model]
name = "threshold"
[states]
x = 0.2
[controls]
u = { lower = -1.5, upper = 1.5, initial = 1 }
[dynamics]
x = "u + 0.5*hy"
[[hysteresis]]
name = "hy"
input = "x"
on = 0.5
off = 0.1
[optimize]
horizon = 1
control_intervals = 2
elements = 5
running_cost = "u^2"
)toml");
  auto& problem = *stated.problem;
  const auto motion = problem.motion(problem.start(), never);
  ASSERT_TRUE(motion);
  expect_feasible(problem, motion->w);
  EXPECT_NEAR(problem.read(motion->w).elements.back().back().end[0], 0.5 + 1.5 * 0.7, 1e-6);
}

/// Its branch has the motion for a solution: without a control nothing is cheaper.
TEST(Motion, ABallThatBouncesBySimulationIsABranch) {
  const auto stated = stated_problem(bouncing_ball);
  auto& problem = *stated.problem;
  const auto motion = problem.motion(problem.start(), never);
  ASSERT_TRUE(motion);
  expect_feasible(problem, motion->w);
  adapters::IpoptSolver ipopt(adapters::LinearSolver::block_ldl);
  const auto branch = solver::crossover::solve_branch(problem, motion->sides, motion->w, ipopt, {});
  EXPECT_TRUE(branch.is_feasible(1e-8));
  EXPECT_NEAR(branch.objective, 0.0, 1e-9);
}

/// While it lies there numerical time goes on faster; intervals end at their physical times.
TEST(Motion, ABoxThatLiesOnTheGroundIsPushedInPhysicalTime) {
  const auto stated = stated_problem(R"toml(
[model]
name = "box"
[states]
x = 0
z = 0
vx = 0
vz = 0
[controls]
u = { lower = -8, upper = 8, initial = 2 }
[mechanics]
positions = ["x", "z"]
velocities = ["vx", "vz"]
force = { vx = "u*if(t > 0.7, 2, 1)", vz = "-9.81" }
[[contacts]]
name = "ground"
gap = "z"
[time_freezing]
a_n = 20
[optimize]
horizon = 1
control_intervals = 4
elements = 2
running_cost = "u^2"
)toml");
  auto& problem = *stated.problem;
  const auto motion = problem.motion(problem.start(), never);
  ASSERT_TRUE(motion);
  expect_feasible(problem, motion->w);
  EXPECT_NEAR(problem.read(motion->w).elements.back().back().end[2], 2.0 * 0.7 + 4.0 * 0.3, 1e-9);
}

/// Its rate has a second selection, which has no side of its own: the ball stays on the hump.
TEST(Motion, ACurvedGapIsHeld) {
  const auto stated = stated_problem(R"toml(
[model]
name = "hump"
[states]
x = -1
z = -0.25
vx = 1
vz = 0.5
[controls]
u = { lower = -8, upper = 8, initial = 0.5 }
[mechanics]
positions = ["x", "z"]
velocities = ["vx", "vz"]
force = { vx = "u", vz = "-9.81" }
[[contacts]]
name = "hump"
gap = "z + x^2/4"
[time_freezing]
a_n = 20
[optimize]
horizon = 1
control_intervals = 4
elements = 1
running_cost = "u^2"
)toml");
  auto& problem = *stated.problem;
  const auto motion = problem.motion(problem.start(), never);
  ASSERT_TRUE(motion);
  expect_feasible(problem, motion->w);
  const auto end = problem.read(motion->w).elements.back().back().end;
  EXPECT_NEAR(end[1] + end[0] * end[0] / 4.0, 0.0, 1e-9);
}

/// At its start it leaves 0.1 and crosses 0.2, once; the states it is meant to have do not.
TEST(NearStates, LeadAMotionThatIsNotStable) {
  const auto stated = stated_problem(R"toml(
[model]
name = "unstable"
[states]
x = 0.1
[controls]
u = { lower = -8, upper = 8, initial = -0.88 }
[dynamics]
x = "4*x + u - 0.5*sign(x - 0.2)"
[optimize]
horizon = 1
control_intervals = 5
elements = 2
running_cost = "u^2"
[optimize.initial_guess]
x = "0.1"
)toml");
  auto& problem = *stated.problem;
  const auto alone = problem.motion_modes(problem.start(), never);
  const auto near = problem.motion_modes(problem.start(), never, true);
  ASSERT_TRUE(alone && near);
  EXPECT_NE(elements_of(*alone), std::vector<int>(5, 1));
  EXPECT_EQ(elements_of(*near), std::vector<int>(5, 1));
  const auto motion = problem.motion(problem.start(), *near);
  ASSERT_TRUE(motion);
  for (const auto& interval : problem.read(motion->w).elements) EXPECT_NEAR(interval.back().end[0], 0.1, 0.02);
}

}  // namespace
}  // namespace saltus::discretization
