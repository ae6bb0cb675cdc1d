// The mode sequence of states that a guess states, and what becomes of it.
#include <algorithm>
#include <string>

#include <gtest/gtest.h>

#include "saltus/adapters/highs/highs_lpcc.hpp"
#include "saltus/adapters/ipopt/ipopt_solver.hpp"
#include "saltus/solver/solve.hpp"
#include "stated_problem.hpp"

namespace saltus::discretization {
namespace {

/// A ball that is to stay on the ground; a guess says when it gets there.
std::string landing_ball(const std::string& guess) {
  return R"toml(
[model]
name = "ball"
[states]
z = 0.5
vz = 0
[controls]
u = { lower = -4, upper = 4, initial = 0 }
[mechanics]
positions = ["z"]
velocities = ["vz"]
force = { vz = "u - 9.81" }
[[contacts]]
name = "ground"
gap = "z"
[time_freezing]
a_n = 30
[optimize]
horizon = 1
control_intervals = 5
elements = 3
stages = 2
running_cost = "u^2"
)toml" + guess;
}

/// On the ground from t = 0.5 on, within the third interval.
std::string stated_guess(const std::string& first) {
  return "[optimize.initial_guess]\nz = \"max(0.5 - t, 0)\"\nvz = \"if(t < 0.5, -1, 0)\"\n[optimize.mpcc]\nfirst = \"" +
         first + "\"\n";
}

TEST(StatedModes, TheKinksOfAGuessAreNoSwitches) {
  const auto plain = stated_problem(landing_ball("")), stated = stated_problem(landing_ball(stated_guess("relaxed")));
  EXPECT_EQ(plain.problem->variables(), stated.problem->variables());
  EXPECT_EQ(plain.problem->pairs(), stated.problem->pairs());
}

/// While the ball is stopped time stands still, so that the elements end behind the horizon.
TEST(StatedModes, MultipliersHaveTimesOfTheClock) {
  const std::string terminal = "terminal_constraints = [\"vz == 0\"]\n";
  const auto stated = stated_problem(landing_ball(terminal + stated_guess("modes")));
  const auto& problem = *stated.problem;
  const auto w = problem.start();
  const auto last = problem.read(w).elements.back().back();
  ASSERT_GT(last.t + last.h, 1.005);
  const auto found = problem.constraint_multipliers(w, linalg::Vector::zero(problem.constraints()), {});
  ASSERT_FALSE(found.empty());
  for (const auto& multiplier : found) EXPECT_LE(multiplier.time, 1.0 + 1e-12) << multiplier.name;
  const auto at_end = std::find_if(found.begin(), found.end(), [](const auto& one) { return one.name == "vz == 0"; });
  ASSERT_NE(at_end, found.end());
  EXPECT_NEAR(at_end->time, 1.0, 1e-12);
}

/// An element falls, one stands still in time while the ball is stopped, one rests.
TEST(StatedModes, AContactThatClosesGetsAnElementInWhichTimeStands) {
  const auto stated = stated_problem(landing_ball(stated_guess("modes")));
  const auto solution = stated.problem->read(stated.problem->start());
  const auto& landing = solution.elements[2];
  ASSERT_EQ(landing.size(), 3u);
  EXPECT_NEAR(landing[0].end[0], 0.0, 1e-9);
  EXPECT_GT(landing[0].h, landing[1].h);
  EXPECT_GT(landing[2].h, landing[1].h);
  EXPECT_GT(solution.speed_of_time[2], 1.0);
  EXPECT_NEAR(solution.speed_of_time[0], 1.0, 1e-12);
}

/// It falls for sqrt(2 0.5 / 9.81) = 0.319, within the second interval; that costs nothing.
TEST(StatedModes, ModesThatAreNoMotionAreChanged) {
  const auto stated = stated_problem(landing_ball(stated_guess("modes")));
  adapters::IpoptSolver ipopt(adapters::LinearSolver::block_ldl);
  adapters::HighsLpcc highs;
  solver::SolveOptions options;
  options.first = solver::FirstProblem::modes;
  const auto solution = solver::solve(*stated.problem, ipopt, highs, options);
  ASSERT_TRUE(solution);
  EXPECT_EQ(solution->termination, result::Termination::completed) << solution->message;
  EXPECT_TRUE(std::none_of(solution->homotopy.begin(), solution->homotopy.end(),
                           [](const auto& step) { return step.message.starts_with("begins at"); }));
}

}  // namespace
}  // namespace saltus::discretization
