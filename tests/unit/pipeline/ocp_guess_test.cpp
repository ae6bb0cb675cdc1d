// Where an optimisation begins.
#include "saltus/pipeline/optimal_control/ocp_guess.hpp"

#include <cmath>
#include <string>
#include <utility>

#include "ocp_problem.hpp"

namespace saltus::pipeline {
namespace {

using casadi::SX;
using model::Builder;
using model::Ocp;
using model::OcpGuess;

/// The simulation of a guess has tolerances of 1e-6, and fields here are polynomials.
constexpr double near = 1e-6;
/// Half of the last digit that a guess between 8 and 16 says: it has 14 binary ones.
constexpr double half_digit = 0x1p-11;

OcpStart started(const Ocp& ocp, int intervals, const std::vector<double>& fractions) {
  auto start = guess_start(ocp, intervals, fractions);
  EXPECT_TRUE(start.has_value()) << (start ? "" : to_text(start.error()));
  return start ? *start : OcpStart{};
}

/// q' = v, v' = u (1 + 2 step(v - 10)); outputs as added.
Builder geared_car(double top_speed = 100.0) {
  Builder model("geared car");
  model.state("q", {0.0, 0.0, 150.0});
  const SX v = model.state("v", {0.0, 0.0, top_speed});
  const SX u = model.control("u", {2.0, -5.0, 5.0});
  model.dynamics("q", v);
  model.dynamics("v", u * (1 + 2 * model.step(10 - v, "slow")));
  return model;
}

TEST(OcpGuessTest, ExpressionsOfTime) {
  Builder model = geared_car();
  const SX t = model.time();
  model.output("q_guess", 200 * t / 10);
  model.output("v_guess", model.if_(model::less(t, SX(4)), SX(1), SX(2)) + model.floor(t));
  model.output("u_guess", t - 1);
  Ocp ocp = problem_of(model, 10.0);
  ocp.guess.list = {{OcpGuess::Kind::state, 0, 0}, {OcpGuess::Kind::state, 1, 1}, {OcpGuess::Kind::control, 0, 2}};
  const auto start = started(ocp, 5, {0.0, 0.25, 0.5, 1.0});
  EXPECT_EQ(start.horizon, 10.0);
  EXPECT_EQ(start.initial_state, (std::vector<double>{0.0, 0.0}));  // it is not free
  EXPECT_EQ(start.states, (std::vector<std::vector<double>>{{0, 1}, {50, 3}, {100, 7}, {150, 12}}));
  EXPECT_EQ(start.controls, (std::vector<std::vector<double>>{{0}, {2}, {4}, {5}, {5}}));
  EXPECT_EQ(start.alpha, (std::vector<std::vector<double>>(4)));
  ASSERT_EQ(start.warnings.size(), 2U);
  EXPECT_EQ(start.warnings[0], "the initial guess of control 'u' is 6 and was moved onto the bounds [-5, 5]");
  EXPECT_EQ(start.warnings[1], "the initial guess of 'q' is 200 and was moved onto the bounds [0, 150]");
}

TEST(OcpGuessTest, ClocksAreTheTime) {
  Builder model = geared_car();
  const SX clock = model.state("clock", {0.0, -infinity, infinity});
  model.dynamics("clock", SX(1));
  model.output("q_guess", 3 * clock);
  Ocp ocp = problem_of(model, 4.0);
  ocp.clock = model::OcpClock{.state = 2, .speed_lower = 1.0, .speed_upper = 2.0};
  ocp.guess.list = {{OcpGuess::Kind::state, 0, 0}};
  const auto start = started(ocp, 2, {0.0, 0.5, 1.0});
  ASSERT_EQ(start.states.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(start.states[i][0], 6.0 * static_cast<double>(i));
}

TEST(OcpGuessTest, SimulationOfTheGuessedControls) {
  // v' = 6 until v = 10 at 5/3, then 2.
  Builder model = geared_car();
  const auto start = started(problem_of(model, 4.0), 4, {0.0, 0.25, 0.25, 0.5, 1.0});
  ASSERT_EQ(start.states.size(), 5U);
  const double edge = 5.0 / 3.0;
  EXPECT_NEAR(start.states[1][1], 6.0, near);
  EXPECT_EQ(start.states[1], start.states[2]);
  EXPECT_NEAR(start.states[1][0], 3.0, near);
  EXPECT_NEAR(start.states[3][1], 10.0 + 2.0 * (2.0 - edge), half_digit);
  EXPECT_NEAR(start.states[4][1], 10.0 + 2.0 * (4.0 - edge), half_digit);
  EXPECT_EQ(start.alpha, (std::vector<std::vector<double>>{{1}, {1}, {1}, {0}, {0}}));
  EXPECT_TRUE(start.warnings.empty());
}

TEST(OcpGuessTest, DigitsThatComeFromStepsAreNoPartOfIt) {
  // A state that stands still changes the first step, and with it the last digits of the others.
  const auto guessed = [](bool has_idle) {
    Builder model("pendulum");
    const SX angle = model.state("angle", {1.0}), rate = model.state("rate", {0.0});
    model.dynamics("angle", rate);
    model.dynamics("rate", -sin(angle));
    if (has_idle) {
      model.state("idle", {3.7});
      model.dynamics("idle", 0);
    }
    auto states = started(problem_of(model, 5.0), 5, {0.0, 0.1, 0.35, 0.7, 1.0}).states;
    for (auto& x : states) {
      EXPECT_EQ(x.back(), has_idle ? 3.7 : x[1]);
      x.resize(2);
    }
    return states;
  };
  const auto states = guessed(false);
  ASSERT_EQ(states.size(), 5U);
  EXPECT_EQ(states, guessed(true));
  EXPECT_EQ(states.front(), (std::vector<double>{1.0, 0.0}));
  for (const auto& x : states) EXPECT_NEAR(x[1] * x[1] / 2 - std::cos(x[0]), -std::cos(1.0), 4 * half_digit);
}

TEST(OcpGuessTest, SimulatedStatesArePutOntoTheirBounds) {
  Builder model = geared_car(8.0);
  const auto start = started(problem_of(model, 4.0), 1, {0.0, 1.0});
  EXPECT_EQ(start.states[1][1], 8.0);
  EXPECT_TRUE(start.warnings.empty());
}

TEST(OcpGuessTest, LinesToTerminalConstraintsOfFreeHorizons) {
  Builder line("line");
  const SX p = line.parameter("p", 2.0), q = line.state("q", {4.0}), v = line.state("v", {1.0});
  line.dynamics("q", v);
  line.dynamics("v", 0);
  line.output("end", p * q + 3);
  line.output("curved", v * v);
  Ocp ocp = problem_of(line, 2.0);
  ocp.horizon = {true, 2.0, 1.0, 5.0};
  ocp.terminal = {constraint(0, 23.0, 23.0), constraint(1, 4.0, 4.0)};
  const auto start = started(ocp, 2, {0.0, 0.5, 1.0});
  const std::vector<std::vector<double>> expected{{4, 1}, {7, 1}, {10, 1}};
  EXPECT_EQ(start.states, expected);
  EXPECT_EQ(start.alpha.size(), 3U);
  ocp.horizon.free = false;  // then the simulation comes first
  EXPECT_NEAR(started(ocp, 2, {0.0, 0.5, 1.0}).states[2][0], 6.0, near);
}

/// q' = v, v' = q + u runs away; outputs: (q - t)^2 + 2 v^2, (q - 5)^2.
Ocp runaway() {
  Builder model("runaway");
  const SX q = model.state("q", {1.0}), v = model.state("v", {0.0, -0.5, 0.5});
  const SX u = model.control("u", {0.0});
  model.dynamics("q", v);
  model.dynamics("v", q + u);
  model.output("running", (q - model.time()) * (q - model.time()) + 2 * v * v + u * u);
  model.output("last", (q - 5) * (q - 5));
  return problem_of(model, 2.0);
}

TEST(OcpGuessTest, OtherGuessesOfStates) {
  const Ocp ocp = runaway();
  const std::vector<double> fractions{0.0, 0.5, 1.0};
  const auto start = started(ocp, 4, fractions);
  ASSERT_EQ(start.others.size(), 1U);  // no cost names a state
  EXPECT_EQ(start.others[0].states, (std::vector<std::vector<double>>(3, {1.0, 0.0})));
}

TEST(OcpGuessTest, StatesThatCostsName) {
  Ocp ocp = runaway();
  const std::vector<double> fractions{0.0, 0.5, 1.0};
  const auto named = [&] { return started(ocp, 4, fractions).others.back().states; };
  const auto expect = [](const std::vector<std::vector<double>>& states, const std::vector<double>& q) {
    for (std::size_t i = 0; i < q.size(); ++i) {
      EXPECT_NEAR(states[i][0], q[i], 1e-9) << i;
      EXPECT_NEAR(states[i][1], 0.0, 1e-9) << i;
    }
  };
  ocp.running_cost = 0;  // the curve t, and what is off at the start fades
  expect(named(), {1.0, 1.5, 2.0});
  ocp.terminal_cost = 1;
  expect(named(), {1.0, 3.0, 5.0});
  ocp.running_cost.reset();
  expect(named(), {1.0, 3.0, 5.0});
  ocp.guess.list = {{OcpGuess::Kind::state, 0, 1}};  // what is stated stays
  EXPECT_EQ(named()[1], (std::vector<double>{16.0, 0.0}));
  ocp.guess.list.push_back({OcpGuess::Kind::state, 1, 1});
  EXPECT_TRUE(started(ocp, 4, fractions).others.empty());
}

TEST(OcpGuessTest, WhereTheSimulationStops) {
  Builder model("root");
  const SX x = model.state("x", {0.5}), y = model.state("y", {0.0});
  model.dynamics("x", -1);
  model.dynamics("y", sqrt(x));
  model.output("end", 2 * x);
  Ocp ocp = problem_of(model, 1.0);
  auto start = started(ocp, 1, {0.0, 0.25, 0.75, 1.0});
  EXPECT_NEAR(start.states[1][0], 0.25, near);
  EXPECT_NEAR(start.states[2][0], 0.0, 1e-3);  // it stops somewhere before
  EXPECT_EQ(start.states[2], start.states[3]);
  EXPECT_TRUE(start.alpha[1].empty());  // no selections
  ocp.terminal = {constraint(0, 2.0, 2.0)};
  start = started(ocp, 1, {0.0, 0.25, 0.75, 1.0});
  EXPECT_NEAR(start.states[2][0], 0.5, 1e-3);
  EXPECT_EQ(start.states[3][0], 1.0);
  EXPECT_EQ(start.states[2][1], start.states[3][1]);
}

TEST(OcpGuessTest, StatesThatLeaveAllMeasure) {
  Builder model("explosion");
  const SX x = model.state("x", {1.0});
  model.dynamics("x", 10 * x);
  const auto start = started(problem_of(model, 10.0), 1, {0.0, 0.1, 1.0});
  EXPECT_NEAR(start.states[1][0], std::exp(10.0), 32.0);  // of up to 1e6, in 14 binary digits
  EXPECT_LE(start.states[2][0], 1e6);
}

TEST(OcpGuessTest, FreeInitialStatesAndParameters) {
  Builder model("free");
  const SX a = model.parameter("a", 1.0), b = model.parameter("b", 3.0);
  const SX x = model.state("x", {0.0, -1.0, 1.0}), y = model.state("y", {5.0, -2.0, 2.0});
  model.dynamics("x", a);
  model.dynamics("y", b - b);
  model.output("x_guess", a / 2 + model.time());
  model.output("a_guess", 2 * b);
  Ocp ocp = problem_of(model, 1.0);
  ocp.free_states = {true, true};
  ocp.free_parameters = {true, false};
  ocp.parameter_lower[0] = 0.0;
  ocp.parameter_upper[0] = 1.5;
  ocp.guess.list = {{OcpGuess::Kind::state, 0, 0}, {OcpGuess::Kind::parameter, 0, 1}};
  const auto start = started(ocp, 1, {0.0, 1.0});
  EXPECT_EQ(start.parameters, (std::vector<double>{1.5, 3.0}));
  EXPECT_EQ(start.initial_state, (std::vector<double>{0.75, 2.0}));
  EXPECT_EQ(start.states, (std::vector<std::vector<double>>{{0.75, 2.0}, {1.0, 2.0}}));
  EXPECT_EQ(start.warnings.size(), 3U);  // a, y at the start, x at the end
}

TEST(OcpGuessTest, GuessesThatAreNotFinite) {
  Builder model = geared_car();
  model.output("v_guess", log(1 - model.time()));
  Ocp ocp = problem_of(model, 2.0);
  ocp.guess.list = {{OcpGuess::Kind::state, 1, 0}};
  const auto start = guess_start(ocp, 1, {0.0, 0.5, 1.0});
  ASSERT_FALSE(start.has_value());
  EXPECT_EQ(start.error().message, "the initial guess of 'v' is -inf at t = 1");
}

TEST(OcpGuessTest, SlacksHoldTheirInequalities) {
  // outer >= |inner| + 1, inner >= |u|, as max(abs(u)) would be nested.
  Builder model("slacks");
  const SX x = model.state("x", {0.0}), u = model.control("u", {-3.0});
  const SX outer = model.control("outer", {0.0}), inner = model.control("inner", {0.0});
  model.dynamics("x", u);
  model.output("row1", inner + 1 - outer);
  model.output("row2", u - inner);
  model.output("row3", -u - inner);
  Ocp ocp = problem_of(model, 1.0);
  ocp.user_controls = 1;
  for (int i = 0; i < 3; ++i) {
    ocp.path.push_back(constraint(i, -infinity, 0.0));
    ocp.path.back().is_slack = true;
  }
  const auto start = started(ocp, 2, {0.0, 1.0});
  EXPECT_EQ(start.controls, (std::vector<std::vector<double>>{{-3, 4, 3}, {-3, 4, 3}}));
}

TEST(OcpGuessTest, SelectionsOfSlidingAndOfKinks) {
  // Sliding on x = 0 with 1 - 2 alpha = -1/2, that is sign(x) = 1/2; |y| is a kink without column.
  Builder model("sliding");
  const SX x = model.state("x", {0.0}), y = model.state("y", {-1.0});
  model.dynamics("x", 0.5 - model.sign(x));
  model.dynamics("y", model.abs(y));
  const auto start = started(problem_of(model, 0.5), 1, {0.0, 1.0});
  ASSERT_EQ(start.alpha[1].size(), 2U);
  EXPECT_NEAR(start.alpha[1][0], 0.75, near);
  EXPECT_EQ(start.alpha[1][1], 0.0);
}

}  // namespace
}  // namespace saltus::pipeline
