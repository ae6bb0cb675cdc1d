// initial(q) in terminal constraints and costs: periodic problems, and what an end has to do with its start.
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "ocp_models.hpp"
#include "saltus/expression/parser.hpp"
#include "saltus/model/optimal_control/ocp_builder.hpp"

namespace saltus::ocp_tests {
namespace {

using result::Termination;

/// xdot = rate, the problem from 0 to 2 in four intervals.
std::string problem_of(const std::string& state, const std::string& rate, const std::string& problem) {
  return fmt::format(R"toml([model]
name = "start and end"
[states]
x = {}
[controls]
u = {{ lower = -5, upper = 5 }}
[dynamics]
x = "{}"
[optimize]
horizon = 2
control_intervals = 4
running_cost = "u^2"
{})toml",
                     state, rate, problem);
}

const std::string free_state = "{ initial = 0.2, lower = -2, upper = 2, free = true }";
const std::string periodic = "terminal_constraints = [\"x == initial(x)\"]";

/// The mean of u + 1 is 0: J = 2.
TEST(InitialValues, APeriodicProblemHasItsControlsOnly) {
  for (const auto& state : {free_state, std::string("0.7")}) {
    const auto result = optimized(stated(problem_of(state, "u + 1", periodic)));
    EXPECT_EQ(result.status.termination, Termination::completed) << result.status.message;
    EXPECT_NEAR(result.optimization->objective, 2.0, 1e-8);
    EXPECT_NEAR(result.final.x[0], result.trajectory.x.front()[0], 1e-8);
    EXPECT_TRUE(result.optimization->parameters.empty());
    EXPECT_TRUE(result.model.parameters.empty());
  }
}

/// xdot = 1/4 - sign(x): from elsewhere it falls to 0 and stays there.
TEST(InitialValues, ASlidingModeIsPeriodic) {
  const auto result =
      optimized(stated(problem_of(free_state, "u - sign(x)", periodic + "\npath_constraints = ['u == 0.25']")));
  EXPECT_EQ(result.status.termination, Termination::completed) << result.status.message;
  EXPECT_NEAR(result.trajectory.x.front()[0], 0.0, 1e-6);
  EXPECT_NEAR(result.final.x[0], 0.0, 1e-6);
}

/// J = 2 u^2 + (2 u - 1)^2, least at u = 1/3, wherever it begins.
TEST(InitialValues, ACostOfTheWayFromTheStart) {
  const std::string cost = "terminal_cost = \"(x - initial(x) - 1)^2\"";
  for (const auto& state : {free_state, std::string("-1.5")}) {
    const auto result = optimized(stated(problem_of(state, "u", cost)));
    EXPECT_EQ(result.status.termination, Termination::completed) << result.status.message;
    EXPECT_NEAR(result.optimization->objective, 1.0 / 3.0, 1e-8);
  }
}

TEST(InitialValues, FollowWhatIsSet) {
  auto file = io::parse_model(problem_of("1", "u", "terminal_constraints = [\"x == 2*initial(x)\"]"), "test.toml");
  ASSERT_TRUE(file) << to_text(file.error());
  const auto three = expression::number(3.0, {});
  const auto ocp = model::build_ocp(file->description, {{"x", three}});
  ASSERT_TRUE(ocp) << to_text(ocp.error());
  const auto result = pipeline::optimize(*ocp, *file->optimize);
  ASSERT_TRUE(result) << to_text(result.error());
  EXPECT_NEAR(result->final.x[0], 6.0, 1e-8);
}

TEST(InitialValues, ABuilderStatesThemToo) {
  model::Builder model("periodic");
  const auto x = model.state("x", {0.2, -2.0, 2.0});
  const auto u = model.control("u", {0.0, -5.0, 5.0});
  model.dynamics("x", u + 1.0);
  model::OcpBuilder problem(std::move(model));
  problem.horizon(2.0);
  problem.running_cost(u * u);
  problem.free_state("x");
  problem.terminal_constraint("periodic", 0.0, x - problem.initial("x"), 0.0);
  const auto ocp = problem.build();
  ASSERT_TRUE(ocp) << to_text(ocp.error());
  pipeline::OptimizeOptions options;
  options.control_intervals = 4;
  const auto result = pipeline::optimize(*ocp, options);
  ASSERT_TRUE(result) << to_text(result.error());
  EXPECT_EQ(result->status.termination, Termination::completed) << result->status.message;
  EXPECT_NEAR(result->optimization->objective, 2.0, 1e-8);
}

std::string refusal_of(const std::string& text) {
  auto file = io::parse_model(text, "bad.toml");
  if (!file) return to_text(file.error());
  const auto ocp = model::build_ocp(file->description);
  return ocp ? "" : to_text(ocp.error());
}

TEST(InitialValues, StandNowhereElse) {
  const std::string elsewhere = "'initial(x)' may stand in terminal_constraints and terminal_cost of [optimize] only";
  for (const auto& [text, place] :
       {std::pair{problem_of("1", "u - initial(x)", ""), "bad.toml:8:10"},
        std::pair{problem_of("1", "u", "path_constraints = [\"x <= initial(x)\"]"), "bad.toml:13:27"},
        std::pair{problem_of("1", "u", "initial_guess = { x = \"initial(x)\" }"), "bad.toml:13:24"}}) {
    const auto refusal = refusal_of(text);
    EXPECT_NE(refusal.find(elsewhere), std::string::npos) << refusal;
    EXPECT_NE(refusal.find(place), std::string::npos) << refusal;
    EXPECT_NE(refusal.find("the number or the parameter that is the initial value"), std::string::npos) << refusal;
  }
}

TEST(InitialValues, AreOfStates) {
  const auto of_control = refusal_of(problem_of("1", "u", "terminal_cost = \"initial(u)^2\""));
  EXPECT_NE(of_control.find("bad.toml:13:26: error: expected the name of a state in initial(...), found 'u'"),
            std::string::npos)
      << of_control;
  const auto of_sum = refusal_of(problem_of("1", "u", "terminal_cost = \"initial(x + 1)\""));
  EXPECT_NE(of_sum.find("expected the name of a state in initial(...), found 'x+1'"), std::string::npos) << of_sum;
}

}  // namespace
}  // namespace saltus::ocp_tests
