// Problems whose costs, constraints, references and guesses hold tables, floor and mod of time, and tables of states.
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "ocp_models.hpp"
#include "saltus/model/optimal_control/ocp_influence.hpp"

namespace saltus::ocp_tests {
namespace {

using result::Termination;

constexpr const char* tables = R"toml(
[tables.r]
x = [0, 1, 2]
y = [0, 1, 0]
[tables.road]
x = [-1, 0, 1]
y = [0, 0, 1]
[definitions]
target = "r(t)"
)toml";

/// xdot = u, in four intervals up to t = 2.
std::string integrator(const std::string& problem, const std::string& state = "0") {
  return fmt::format(R"toml(
[model]
name = "integrator"
[states]
x = {}
[controls]
u = {{ lower = -5, upper = 5 }}
{}
[dynamics]
x = "u"
[optimize]
horizon = 2
control_intervals = 4
{})toml",
                     state, tables, problem);
}

void expect_objective(const std::string& problem, double objective) {
  const auto result = optimized(stated(integrator(problem)));
  EXPECT_EQ(result.status.termination, Termination::completed) << problem << ": " << result.status.message;
  EXPECT_NEAR(result.optimization->objective, objective, 1e-8) << problem;
}

double objective_of(const std::string& problem) {
  return optimized(stated(integrator(problem))).optimization->objective;
}

TEST(FunctionsOfTime, ATableOfTimeIsTheKinkedFunctionThatItDraws) {
  const std::string rest = " + 0.1*u^2\"";
  const double drawn = objective_of("running_cost = \"(x - min(t, 2 - t))^2" + rest);
  expect_objective("running_cost = \"(x - r(t))^2" + rest, drawn);
  expect_objective("running_cost = \"(x - target)^2" + rest, drawn);
  EXPECT_GT(drawn, 0.1);
  // x = r(t) itself
  expect_objective("[[optimize.least_squares]]\nof = [\"x\"]\nreference = [\"r(t)\"]", 0.0);
  expect_objective("[[optimize.least_squares]]\nof = [\"x\"]\nreference = [\"target\"]\nat = \"stages\"", 0.0);
}

/// min int u^2 with x >= r(t) at the ends of intervals: up to 1 in time 1, and no further.
TEST(FunctionsOfTime, ConstraintsFollowATable) {
  expect_objective("running_cost = \"u^2\"\npath_constraints = [\"x >= r(t)\"]", 1.0);
  expect_objective("running_cost = \"u^2\"\nterminal_constraints = [\"x == 1 + r(t)\"]", 0.5);
}

/// At the end the time is 2: floor and mod have their values there, not those of the last interval.
TEST(FunctionsOfTime, AtTheEndIsAtTheTimeOfTheEnd) {
  expect_objective("running_cost = \"u^2\"\nterminal_constraints = [\"x == floor(t)\"]", 2.0);
  expect_objective("running_cost = \"u^2\"\nterminal_constraints = [\"x == 2 + mod(t, 1)\"]", 2.0);
  expect_objective("running_cost = \"u^2\"\nterminal_constraints = [\"x == if(t >= 2, 2, 0)\"]", 2.0);
  expect_objective("running_cost = \"u^2\"\nterminal_constraints = [\"x == if(t < 2, 0, 2)\"]", 2.0);
  // stationary: u = -(x - 2)/2 with x = 2 u
  expect_objective("running_cost = \"u^2\"\nterminal_cost = \"(x - floor(t))^2\"", 4.0 / 3.0);
  // x(1/2), x(1), x(3/2), x(2) = 0, 1, 1, 2
  expect_objective("[[optimize.least_squares]]\nof = [\"x\"]\nreference = [\"floor(t)\"]", 0.0);
}

/// The interval has its own piece up to its end: int mod(t, 1) dt = 1.
TEST(FunctionsOfTime, IntegralsTakeThePieceOfTheirInterval) {
  expect_objective("running_cost = \"mod(t, 1) + u^2\"", 1.0);
  expect_objective("running_cost = \"floor(t) + u^2\"", 1.0);
}

/// The table road is max(x, 0). The corner of x <= 0.3 + road(x)/2 is x = 0.6.
TEST(FunctionsOfTime, ATableOfAStateSwitchesAtItsBreaks) {
  const auto optimum = [](const std::string& ramp) {
    const auto result = optimized(
        stated(integrator("running_cost = \"" + ramp + " + u^2\"\npath_constraints = [\"x <= 0.3 + 0.5*" + ramp +
                              "\"]\nterminal_constraints = [\"x == 0.5\"]\nterminal_cost = \"" + ramp + "\"",
                          "{ initial = -0.5, lower = -0.9, upper = 0.9 }")));
    EXPECT_EQ(result.status.termination, Termination::completed) << result.status.message;
    return result.optimization->objective;
  };
  const double drawn = optimum("max(x, 0)");
  EXPECT_NEAR(optimum("road(x)"), drawn, 1e-7);
  EXPECT_GT(drawn, 1.0);
}

TEST(FunctionsOfTime, GuessesMayHaveKinksAndJumps) {
  const auto problem = stated(integrator(
      "running_cost = \"(x - 1)^2 + u^2\"\ninitial_guess = { x = \"r(t)\", u = \"if(t > 1, 1, 0) + floor(t)\" }"));
  auto state = pipeline::state_problem(problem.ocp, problem.options);
  ASSERT_TRUE(state) << to_text(state.error());
  EXPECT_EQ(optimized(problem).status.termination, Termination::completed);
}

TEST(FunctionsOfTime, ACostThroughATableIsNoIdleOne) {
  EXPECT_TRUE(model::idle_costs(stated(integrator("terminal_cost = \"road(x)\"")).ocp).empty());
  EXPECT_EQ(model::idle_costs(stated(integrator("terminal_cost = \"road(t)\"")).ocp).size(), 1U);
}

/// Outputs that are only looked at may break anywhere.
TEST(FunctionsOfTime, OutputsOfTheUserBreakWhereTheyLike) {
  const auto result = optimized(stated(integrator(R"toml(running_cost = "(x - t)^2 + u^2"
[outputs]
looked = "mod(t, 0.3)"
)toml")));
  EXPECT_EQ(result.status.termination, Termination::completed) << result.status.message;
}

}  // namespace
}  // namespace saltus::ocp_tests
