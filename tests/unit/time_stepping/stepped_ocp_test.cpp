// Time stepping against motions in closed form: errors of first order, rest by friction, and what it does not state.
#include "saltus/time_stepping/stepped_ocp.hpp"

#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "saltus/adapters/highs/highs_lpcc.hpp"
#include "saltus/adapters/ipopt/ipopt_solver.hpp"
#include "saltus/io/toml/toml_model.hpp"
#include "saltus/model/ocp.hpp"
#include "saltus/solver/solve.hpp"

namespace saltus::time_stepping {
namespace {

model::Ocp ocp_of(const std::string& text) {
  const auto file = io::parse_model(text, "model.toml");
  EXPECT_TRUE(file) << (file ? "" : to_text(file.error()));
  auto ocp = model::build_ocp(file->description);
  EXPECT_TRUE(ocp) << (ocp ? "" : to_text(ocp.error()));
  return std::move(*ocp);
}

/// A guess that stays where it begins.
Motion resting(const model::Ocp& ocp, int intervals) {
  const auto& system = *ocp.physical;
  const auto count = static_cast<std::size_t>(intervals);
  return {.horizon = ocp.horizon.value,
          .parameters = system.parameter_values,
          .controls = std::vector(count, system.control_initial),
          .initial_state = system.initial_state,
          .states = std::vector(ends_of_steps(intervals).size(), system.initial_state)};
}

Motion solved(const model::Ocp& ocp, int intervals) {
  const auto stepped = SteppedOcp::make(ocp, intervals, resting(ocp, intervals));
  EXPECT_TRUE(stepped);
  solver::SolveOptions options;
  options.crossover = false;
  options.starts = 1;
  options.sigma_initial = 1.0;
  adapters::IpoptSolver ipopt(adapters::linear_solver_of(options.strategy));
  adapters::HighsLpcc highs;
  const auto solution = solver::solve(stepped->problem(), ipopt, highs, options);
  EXPECT_TRUE(solution);
  EXPECT_LE(solution->certificate.primal_infeasibility, 1e-6);
  return stepped->read(solution->w);
}

std::string falling(const std::string& more) {
  return R"toml(
[model]
name = "ball"
[states]
x = 0
z = 0.2
vx = 1
vz = 0
[controls]
u = { lower = 0, upper = 0, initial = 0 }
[mechanics]
positions = ["x", "z"]
velocities = ["vx", "vz"]
potential = "10*z"
force = { vx = "u" }
[[contacts]]
name = "ground"
gap = "z"
)toml" + more +
         R"toml(
[optimize]
horizon = 0.4
control_intervals = 4
terminal_cost = "x^2"
)toml";
}

/// It hits the ground at t = 0.2, and slides on at its speed.
TEST(SteppedOcp, ABallThatFallsStaysOnTheGround) {
  const auto motion = solved(ocp_of(falling("")), 4);
  EXPECT_NEAR(motion.states.back()[0], 0.4, 1e-6);
  for (const auto& x : motion.states) EXPECT_GE(x[1], -1e-6);
  EXPECT_NEAR(motion.states.back()[1], 0.0, 1e-4);
  EXPECT_NEAR(motion.states.back()[3], 0.0, 1e-2);
}

/// The impulse of the fall, 2, takes mu 2 of its speed; friction mu 10 the rest within 1/15 s.
TEST(SteppedOcp, FrictionStopsIt) {
  const auto motion = solved(ocp_of(falling("tangent = { x = 1 }\nfriction = 0.3\n")), 8);
  const double after = 1.0 - 0.3 * 2.0, path = 0.2 + after * after / (2.0 * 3.0);
  EXPECT_NEAR(motion.states.back()[2], 0.0, 1e-3);
  EXPECT_NEAR(motion.states.back()[0], path, 0.02);
}

/// A ball in flight has no contact at all: half the step, half the error.
TEST(SteppedOcp, ItsErrorIsOfFirstOrder) {
  const auto ocp = ocp_of(falling("").replace(falling("").find("z = 0.2"), 7, "z = 2.0"));
  const double exact = 2.0 - 5.0 * 0.4 * 0.4;
  double before = 0.0;
  for (const int intervals : {4, 8, 16}) {
    const double error = std::abs(solved(ocp, intervals).states.back()[1] - exact);
    if (before > 0.0) {
      EXPECT_NEAR(before / error, 2.0, 0.05);
    }
    before = error;
  }
}

/// It comes to the ground with a speed of 2 and leaves it with 1 some two steps later: at 0.1 s again on its top of
/// 0.05.
TEST(SteppedOcp, RestitutionGivesBack) {
  const auto ocp = ocp_of(falling("restitution = 0.5\n"));
  double before = 0.0;
  for (const int intervals : {8, 16, 32}) {
    double top = 0.0;
    const auto motion = solved(ocp, intervals);
    const std::size_t middle = motion.states.size() * 5 / 8;
    for (std::size_t k = middle; k < motion.states.size(); ++k) top = std::max(top, motion.states[k][1]);
    const double error = std::abs(top - 0.05);
    if (before > 0.0) {
      EXPECT_NEAR(before / error, 2.0, 0.4);
    }
    before = error;
  }
  EXPECT_LT(before, 3e-3);
}

TEST(SteppedOcp, AFreeHorizonCanBeHeldAtItsGuess) {
  std::string text = falling("");
  text.replace(text.find("horizon = 0.4"), 13, "horizon = { free = true, initial = 0.3, lower = 0.1, upper = 1 }");
  const auto ocp = ocp_of(text);
  Motion guess = resting(ocp, 4);
  guess.horizon = 0.3;
  for (const bool is_held : {true, false}) {
    const auto stepped = SteppedOcp::make(ocp, 4, guess, is_held);
    const auto& bounds = stepped->problem().variable_bounds();
    EXPECT_EQ(stepped->read(bounds.lower).horizon, is_held ? 0.3 : 0.1);
    EXPECT_EQ(stepped->read(bounds.upper).horizon, is_held ? 0.3 : 1.0);
  }
}

/// At rest at x = 0, vx = 1, z = 0.2: sums over intervals and over steps are integrals, the end counts once.
TEST(SteppedOcp, LeastSquaresAreSummedWhereTheyStand) {
  const auto ocp = ocp_of(falling("") + R"toml(
[[optimize.least_squares]]
of = ["x", "vx"]
reference = ["2", "0"]
weight = [3, 5]
[[optimize.least_squares]]
of = ["z"]
weight = [7]
at = "stages"
[[optimize.least_squares]]
of = ["x"]
reference = ["1"]
weight = [11]
at = "end"
)toml");
  const auto stepped = SteppedOcp::make(ocp, 4, resting(ocp, 4));
  ASSERT_TRUE(stepped);
  auto& problem = stepped->problem();
  EXPECT_NEAR(problem.objective(problem.start()), 0.4 * (3 * 4 + 5 * 1) + 0.4 * 7 * 0.04 + 11, 1e-12);
}

TEST(SteppedOcp, StepsAreEquallyManyInEachInterval) {
  const auto fractions = ends_of_steps(4);
  EXPECT_EQ(fractions.size() % 4, 0U);
  EXPECT_EQ(fractions.back(), 1.0);
}

}  // namespace
}  // namespace saltus::time_stepping
