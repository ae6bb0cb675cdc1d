// What is no optimal control problem of this method, each with the message a person gets; and kinks of controls that
// are.
#include <set>
#include <string>
#include <vector>

#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include "ocp_models.hpp"
#include "saltus/model/build.hpp"

namespace saltus::ocp_tests {
namespace {

/// A double integrator with friction; `tables` and `problem` are added to the tables of the model and to [optimize].
struct Change {
  std::string q = "0";
  std::string v = "0";
  std::string u = "{ lower = -2, upper = 2 }";
  std::string acceleration = "u - 0.5*sign(v)";
  std::string more_states{}, more_dynamics{}, tables{};
  std::string horizon = "2";
  std::string intervals = "2";
  std::string cost = "u^2";
  std::string problem{};
  std::string k = "1";
};

std::string model_of(const Change& change) {
  return fmt::format(R"toml([model]
name = "bad"
[parameters]
k = {11}
[states]
q = {0}
v = {1}
{2}
[controls]
u = {3}
[dynamics]
q = "v"
v = "{4}"
{5}
{6}
[optimize]
horizon = {7}
control_intervals = {8}
running_cost = "{9}"
{10}
)toml",
                     change.q, change.v, change.more_states, change.u, change.acceleration, change.more_dynamics,
                     change.tables, change.horizon, change.intervals, change.cost, change.problem, change.k);
}

/// The first error on the way from text to problem.
std::string refusal_of(const Change& change) {
  auto file = io::parse_model(model_of(change), "bad.toml");
  if (!file) return to_text(file.error());
  if (const auto checked = io::check_optimize_options(*file); !checked) return to_text(checked.error());
  const auto ocp = model::build_ocp(file->description);
  if (!ocp) return to_text(ocp.error());
  const auto made = pipeline::state_problem(*ocp, *file->optimize);
  return made ? "" : to_text(made.error());
}

void expect_refused(const Change& change, const std::vector<std::string>& phrases) {
  const std::string text = refusal_of(change);
  EXPECT_NE(text, "") << model_of(change);
  for (const auto& phrase : phrases) {
    EXPECT_NE(text.find(phrase), std::string::npos) << "'" << phrase << "' is not in\n" << text;
  }
}

TEST(OcpBadInput, TheModelItselfIsAccepted) { EXPECT_EQ(refusal_of({}), ""); }

TEST(OcpBadInput, SwitchesOfControls) {
  expect_refused({.acceleration = "u - 0.5*sign(v - u)"},
                 {"bad.toml:13:14", "switching function 'v-u' depends on the control 'u'", "make 'u' a state"});
  expect_refused({.u = "[-2, 2]"}, {"bad.toml:10:5", "u = { lower = -2, upper = 2 }"});
  expect_refused({.cost = "sign(u)"}, {"'sign(u)'", "running_cost", "convex"});
  expect_refused({.cost = "u^2 + min(u, 0)"}, {"the kink 'min(u,0)' of controls does not enter running_cost convexly"});
  expect_refused({.cost = "-abs(u)"}, {"'abs(u)'", "convexly"});
  expect_refused({.cost = "u^2", .problem = "terminal_cost = 'max(u, v)'"},
                 {"'max(u,v)' in terminal_cost mixes controls with 'v' in one kink"});
  expect_refused({.cost = "u^2", .problem = "path_constraints = [{ constraint = 'abs(u - v) <= 1', penalty = 10 }]"},
                 {"'abs(u - v) <= 1' is soft and has a kink that mixes states and controls"});
  expect_refused({.cost = "-abs(u - v)"}, {"'abs(u-v)'", "convexly"});
  expect_refused({.cost = "u^2", .problem = "path_constraints = ['abs(u) >= 1']"}, {"'abs(u)'", "convexly"});
}

TEST(OcpBadInput, PairsAreNamedByWhatSwitchesAndWhen) {
  const auto names_of = [](const std::string& horizon) {
    const auto problem = stated(model_of({.horizon = horizon}));
    const auto made = pipeline::state_problem(problem.ocp, problem.options);
    EXPECT_TRUE(made);
    const auto& all = *made->problem;
    std::set<std::string> names;
    for (int pair = 0; pair < all.pairs(); ++pair) {
      names.insert(all.row_name(all.constraints() + pair));
      EXPECT_EQ(all.row_name(all.constraints() + pair), all.row_name(all.constraints() + all.pairs() + pair));
    }
    return fmt::format("{}", fmt::join(names, "\n"));
  };
  const auto fixed = names_of("3");
  EXPECT_NE(fixed.find("the switching function 'v' in interval 1 (t = 1.5 to 3), element 2"), std::string::npos)
      << fixed;
  EXPECT_EQ(fixed.find("pair"), std::string::npos) << fixed;
  const auto free = names_of("{ free = true, initial = 2, lower = 1, upper = 3 }");
  EXPECT_NE(free.find("the switching function 'v' in interval 1 (0.5 to 1 of the horizon), element 0"),
            std::string::npos)
      << free;
}

TEST(OcpBadInput, KeysOfSimulationsAreAnswered) {
  expect_refused({.problem = "until = 2"}, {"unknown option optimize.until", "the length of time is `horizon`"});
  expect_refused({.problem = "rtol = 1e-6"}, {"control_intervals, elements and stages", "[simulate]"});
}

TEST(OcpBadInput, JumpsAndDiscreteStates) {
  expect_refused({.tables = "[[jumps]]\nname = \"bounce\"\nwhen = \"q < -1\"\nset = { v = \"-v\" }"},
                 {"does not cover [[jumps]]", "[time_freezing]"});
  expect_refused({.more_states = "gear = 1", .more_dynamics = "gear = 0"},
                 {"the state 'gear' is discrete: nothing moves it", "make it a parameter"});
}

TEST(OcpBadInput, BreaksOfTime) {
  expect_refused({.acceleration = "u + floor(t)", .intervals = "3"},
                 {"bad.toml:13:10", "breaks at t = 1, inside control interval 1", "control_intervals = 4"});
  expect_refused({.acceleration = "u - 0.5*sign(v) + step(t - 0.33)"}, {"bad.toml:13:24", "'t-0.33' breaks"});
  EXPECT_EQ(refusal_of({.acceleration = "u + floor(t)", .intervals = "4"}), "");
  expect_refused({.acceleration = "u + floor(t)", .horizon = "{ free = true, initial = 2, lower = 1, upper = 3 }"},
                 {"breaks in time, and the horizon is free", "fix the horizon"});
}

TEST(OcpBadInput, BreaksOfTimeInCostsAndConstraints) {
  const std::string table = "[tables.r]\nx = [0, 0.75]\ny = [0, 1]\n";
  expect_refused({.tables = table, .cost = "u^2 + r(t)"},
                 {"bad.toml:22:23", "'r(t)' breaks at t = 0.75, inside control interval 0", "control_intervals = 8"});
  expect_refused({.tables = table, .problem = "path_constraints = ['q <= 2', 'v <= r(t)']"},
                 {"bad.toml:23:37", "'r(t)' breaks at t = 0.75"});
  expect_refused({.tables = table, .problem = "[[optimize.least_squares]]\nof = ['q']\nreference = ['r(t)']"},
                 {"bad.toml:25:15", "'r(t)' breaks at t = 0.75"});
}

TEST(OcpBadInput, BreaksWhereSomethingChosenSays) {
  expect_refused(
      {.acceleration = "u + if(t > k, 1, 0)", .tables = "", .k = "{ initial = 1, lower = 0, upper = 2, free = true }"},
      {"bad.toml:13:15", "'t-k' breaks where the free parameter 'k' says", "a state with the rate 1"});
  expect_refused({.acceleration = "r(u)", .tables = "[tables.r]\nx = [0, 1]\ny = [0, 1]\n"},
                 {"bad.toml:13:6", "'r(u)' breaks where the control 'u' says", "make 'u' a state with a rate"});
}

TEST(OcpBadInput, LeastSquares) {
  const std::string head = "[[optimize.least_squares]]\nof = ['q', 'v']\n";
  expect_refused({.problem = head + "reference = [0]"}, {"`of` has 2 expressions, `reference` 1"});
  expect_refused({.problem = head + "weight = [[1, 2], [3, 4]]"},
                 {"the weight is not symmetric: 3 in row 2, column 1, and 2 in row 1, column 2"});
  expect_refused({.problem = head + "weight = [1, 2, 3]"}, {"weight", "2 expressions"});
}

TEST(OcpBadInput, MoreEquationsThanFreedom) {
  expect_refused({.problem = "terminal_constraints = ['q == 1', 'v == 0', 'q + v == 2']"},
                 {"there are 3 equality constraints and only 2 values to choose", "'q == 1', 'v == 0', 'q + v == 2'"});
  expect_refused({.problem = "path_constraints = ['q == 0']\nterminal_constraints = ['v == 0']"},
                 {"there are 3 equality constraints", "'q == 0' at 2 points"});
}

TEST(OcpBadInput, BoundsAndGuesses) {
  expect_refused({.q = "{ initial = 3, lower = -1, upper = 1 }"},
                 {"state 'q' starts at 3, outside of its bounds [-1, 1]", "or make it free"});
  expect_refused({.q = "{ initial = 0, free = true }"}, {"'q' is free and has no lower and no upper bound"});
  expect_refused({.horizon = "{ free = true, initial = 5, lower = 1, upper = 3 }"},
                 {"the horizon: initial (5) is above upper (3)"});
  expect_refused({.cost = "u^2 + log(q)"}, {"running_cost", "not finite at the initial guess", "initial_guess"});
  expect_refused({.problem = "initial_guess = { w = 't' }"},
                 {"expected the name of a state, a control or a free parameter, found 'w'"});
  expect_refused({.problem = "initial_guess = { q = 'v*t' }"}, {"the guess of 'q' depends on states or controls"});
  expect_refused({.problem = "initial_guess = { q = 'min(v, 1)' }"},
                 {"the guess of 'q' depends on states or controls"});
  expect_refused({.tables = "[tables.r]\nx = [0, 1]\ny = [0, 1]\n", .problem = "initial_guess = { q = 'r(v)' }"},
                 {"the guess of 'q' depends on states or controls"});
}

TEST(OcpWarnings, AControlInAPairIsConstantInAnInterval) {
  const auto warnings_of = [](const std::string& pair) {
    const auto problem = stated(model_of({.cost = "k*u^2", .problem = "path_complementarities = [" + pair + "]"}));
    return fmt::format("{}", fmt::join(problem.ocp.warnings, "\n"));
  };
  const auto of_control = warnings_of("['q + 1', 'u + 2']");
  for (const std::string part : {"test.toml:20: the pair ['q+1', 'u+2'] of path_complementarities has the control 'u'",
                                 "constant in each control interval", "make 'u' a state with a rate"}) {
    EXPECT_NE(of_control.find(part), std::string::npos) << of_control;
  }
  EXPECT_EQ(warnings_of("['q + 1', 'v + 2']"), "");
}

TEST(OcpNames, WhatTheProblemAloneUsesIsUsed) {
  const auto file = io::parse_model(
      model_of(
          {.tables = "[definitions]\neffort = \"k*u^2\"\nspeed = \"v\"\nidle = \"q\"",
           .cost = "effort",
           .problem = "terminal_constraints = ['q == 1', { constraint = 'speed <= k', penalty = 2, norm = 'l1' }]"}),
      "names.toml");
  ASSERT_TRUE(file) << to_text(file.error());
  const auto system = model::build(file->description);
  ASSERT_TRUE(system) << to_text(system.error());
  ASSERT_EQ(system->warnings.size(), 1U);
  EXPECT_NE(system->warnings[0].find("definition 'idle' is never used"), std::string::npos) << system->warnings[0];
}

/// min int |u| from rest to rest over one unit of length, |u| <= 2, T = 2: as much speed as is needed, for as long as
/// is needed. u = 2 for s, then 0, then -2: q = 2 s (2 - s) = 1, s = 1 - 1/sqrt(2), cost 4 s. On a grid of five
/// intervals: the best piecewise constant control is that of a linear program. With v the speed behind interval 1 of
/// length h = 0.4, and the same at the other end by symmetry: u is 2 in the first interval where s < h, hence |u| = v/h
/// there, cost 2 v, and q = v (T - h) = 1.6 v = 1: v = 0.625, u = 1.5625 < 2.
TEST(OcpKinksOfControls, LeastConsumption) {
  const auto result = optimized(stated(model_of({.acceleration = "u",
                                                 .intervals = "5",
                                                 .cost = "abs(u)",
                                                 .problem = "terminal_constraints = ['q == 1', 'v == 0']"})));
  ASSERT_EQ(result.status.termination, result::Termination::completed) << result.status.message;
  EXPECT_NEAR(result.optimization->objective, 1.25, 1e-8);
  EXPECT_NEAR(result.optimization->u.front().front(), 1.5625, 1e-7);
  EXPECT_EQ(result.controls, std::vector<std::string>{"u"});  // the slack is no control of the result
  EXPECT_EQ(result.optimization->u.front().size(), 1U);
}

/// x' = u from 1 over one interval of length 1, so that x = 1 + u t.
std::string mixed_kinks(const std::string& problem) {
  return "[model]\nname = \"mixed\"\n[states]\nx = 1\n[controls]\nu = { lower = -2, upper = 2 }\n[dynamics]\nx = "
         "\"u\"\n"
         "[optimize]\nhorizon = 1\ncontrol_intervals = 1\n" +
         problem;
}

/// For u < 1 is u < x behind the start, so that int |u - x| dt = 1 - u/2: with 0.6 u^2 the optimum is u = 5/12.
TEST(OcpKinksOfControls, OfStatesAndControlsInACost) {
  for (const std::string cost : {"abs(u - x) + 0.6*u^2", "max(x - u, u - x) + 0.6*u^2", "0.6*u^2 - min(u - x, 0)"}) {
    const auto result = optimized(stated(mixed_kinks("running_cost = \"" + cost + "\"\n")));
    ASSERT_EQ(result.status.termination, result::Termination::completed) << cost << ": " << result.status.message;
    EXPECT_NEAR(result.optimization->objective, 43.0 / 48.0, 1e-8) << cost;
    EXPECT_NEAR(result.optimization->u.front().front(), 5.0 / 12.0, 1e-7) << cost;
    EXPECT_EQ(result.optimization->u.front().size(), 1U);
    EXPECT_TRUE(result.optimization->multipliers.empty()) << cost;
  }
}

/// At the start x = 1, so that the least u is -1/2; at the end |u - x| = 1.
TEST(OcpKinksOfControls, OfStatesAndControlsInConstraints) {
  for (const std::string constraint : {"abs(u - x) <= 1.5", "abs(u - x) + abs(u) <= 2",
                                       "2 >= max(max(x - u, u - x), 0) - min(u, x)", "-1.5 <= -abs(x - u)"}) {
    const auto result =
        optimized(stated(mixed_kinks("running_cost = \"u\"\npath_constraints = [\"" + constraint + "\"]\n")));
    ASSERT_EQ(result.status.termination, result::Termination::completed) << constraint << ": " << result.status.message;
    EXPECT_NEAR(result.optimization->objective, -0.5, 1e-8) << constraint;
  }
}

}  // namespace
}  // namespace saltus::ocp_tests
