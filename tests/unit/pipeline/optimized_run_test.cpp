// Optimised points in the columns of a result: exact solutions written down as points.
#include "saltus/pipeline/optimal_control/optimized_run.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "ocp_problem.hpp"
#include "optimized_points.hpp"
#include "saltus/reformulation/dcs.hpp"

namespace saltus::pipeline {
namespace {

using casadi::SX;
using discretization::OcpSolution;
using linalg::Vector;
using model::Builder;
using model::Ocp;
using result::EventKind;

constexpr double rounding_error = 1e-14;

void expect_near(const std::vector<double>& found, const std::vector<double>& expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(found[i], expected[i], rounding_error) << i;
}

template <class Rows>
std::vector<double> column(const Rows& rows, std::size_t number) {
  std::vector<double> values;
  for (const auto& row : rows) values.push_back(row[number]);
  return values;
}

/// x' = 2 - sign(x) from -1: -1 + 3 t until 1/3, then t - 1/3. Two intervals; an element of the second one vanishes.
double refracted(double t) { return t < 1.0 / 3.0 ? 3.0 * t - 1.0 : t - 1.0 / 3.0; }

Ocp refraction() {
  Builder model("refraction");
  const SX x = model.state("x", {-1.0});
  model.dynamics("x", 2 - model.sign(x));
  return problem_of(model, 1.0);
}

OcpSolution refraction_point(const Exact& below, const Exact& above) {
  OcpSolution solution;
  solution.horizon = 1.0;
  solution.controls = {{}, {}};
  solution.speed_of_time = {1.0, 1.0};
  solution.initial_state = {-1.0};
  const double third = 1.0 / 3.0;
  solution.elements = {{element(0.0, third, below), element(third, 0.5 - third, above)},
                       {element(0.5, 1e-14, below), element(0.5 + 1e-14, 0.5 - 1e-14, above)}};
  return solution;
}

/// alpha with the error of a solver.
OcpSolution refraction_in_step_form() {
  const auto x = [](double t) { return vector({refracted(t)}); };
  const auto lambda = [](double t) { return sides(refracted(t)); };
  const Exact below{x, [](double) { return vector({1e-9}); }, lambda};
  const Exact above{x, [](double) { return vector({1.0 - 1e-9}); }, lambda};
  return refraction_point(below, above);
}

void expect_refraction(const OptimizedRun& run) {
  const auto& rows = run.trajectory;
  const double third = 1.0 / 3.0;
  expect_near(rows.t, {0.0, third / 3, third, third, third + 1.0 / 18, 0.5, 0.5 + 1.0 / 6, 1.0});
  for (std::size_t r = 0; r < rows.t.size(); ++r) EXPECT_NEAR(rows.x[r][0], refracted(rows.t[r]), rounding_error) << r;
  ASSERT_EQ(run.events.size(), 1U);
  const auto& event = run.events.front();
  EXPECT_EQ(event.t, third);
  EXPECT_EQ(event.kind, EventKind::crossing);
  EXPECT_EQ(event.unique, std::nullopt);
  EXPECT_TRUE(event.alternatives.empty());
  EXPECT_FALSE(event.reason.empty());
  EXPECT_EQ(event.x, event.x_after);
  EXPECT_NEAR(event.x[0], 0.0, rounding_error);
  EXPECT_EQ(run.final.t, 1.0);
  EXPECT_NEAR(run.final.x[0], 2.0 / 3.0, rounding_error);
  EXPECT_EQ(run.elements.points, 4U);
  EXPECT_EQ(run.elements.t.size(), 12U);  // the one that vanished has no rows

  const auto& path = run.path;
  EXPECT_EQ(path.horizon, 1.0);
  EXPECT_EQ(path.times, (std::vector<double>{0.0, 0.5, 1.0}));
  expect_near(column(path.nodes, 0), {-1.0, 1.0 / 6, 2.0 / 3});
  EXPECT_EQ(path.controls.size(), 2U);
  EXPECT_EQ(path.state_min, std::vector<double>{-1.0});
  expect_near(path.state_max, {2.0 / 3});
  ASSERT_EQ(path.events.size(), 1U);
  EXPECT_EQ(path.events.front().t, third);
}

TEST(OptimizedRunTest, CrossingInStepForm) {
  const auto run = run_of(refraction(), refraction_in_step_form());
  expect_refraction(run);
  EXPECT_EQ(column(run.trajectory.alpha, 0), (std::vector<double>{0, 0, 0, 1, 1, 1, 1, 1}));
  EXPECT_EQ(run.events.front().mode_before, result::Mode{-1});
  EXPECT_EQ(run.events.front().mode_after, result::Mode{1});
  EXPECT_EQ(run.final.mode, result::Mode{1});
  expect_near(column(run.elements.lambda, 0),
              {-1.0, -2.0 / 3, 0.0, 0.0, 0.0, 1.0 / 18, 1.0 / 6, 1.0 / 6, 1.0 / 6, 1.0 / 3, 2.0 / 3, 2.0 / 3});
}

TEST(OptimizedRunTest, CrossingInStewartsForm) {
  const Ocp ocp = refraction();
  const auto dcs = reformulation::reformulate(ocp.system, {reformulation::Form::stewart, 2});
  ASSERT_TRUE(dcs.has_value());
  ASSERT_EQ(dcs->parts.size(), 1U);
  const auto& table = dcs->parts.front().signs;
  ASSERT_EQ(table.rows(), 2);
  const int signs[] = {table(0, 0), table(1, 0)};
  const auto x = [](double t) { return vector({refracted(t)}); };
  const auto lambda = [&](double t) {
    const double larger = std::abs(refracted(t));
    return vector({larger - signs[0] * refracted(t), larger - signs[1] * refracted(t)});
  };
  const auto theta = [&](int sign) {
    return [&signs, sign](double) { return vector({signs[0] == sign ? 1.0 : 0.0, signs[1] == sign ? 1.0 : 0.0}); };
  };
  const auto run =
      run_of(ocp, refraction_point({x, theta(-1), lambda}, {x, theta(1), lambda}), reformulation::Form::stewart);
  expect_refraction(run);
  EXPECT_EQ(column(run.trajectory.alpha, 0), (std::vector<double>{0, 0, 0, 1, 1, 1, 1, 1}));
  EXPECT_EQ(run.events.front().mode_before, result::Mode{-1});
  EXPECT_EQ(run.events.front().mode_after, result::Mode{1});
  ASSERT_EQ(run.elements.selections.size(), 2U);
  EXPECT_EQ(run.elements.selections.front().form, result::SelectionForm::stewart);
}

TEST(OptimizedRunTest, CrossingOfRegions) {
  Builder model("regions");
  const SX state = model.state("x", {-1.0});
  model.region(state, {{"x", 3}}, "left");
  model.region(-state, {{"x", 1}}, "right");
  const auto x = [](double t) { return vector({refracted(t)}); };
  const auto lambda = [](double t) {
    return vector({2 * std::max(refracted(t), 0.0), 2 * std::max(-refracted(t), 0.0)});
  };
  const Exact left{x, [](double) { return vector({1.0, 0.0}); }, lambda};
  const Exact right{x, [](double) { return vector({0.0, 1.0}); }, lambda};
  const auto run = run_of(problem_of(model, 1.0), refraction_point(left, right));
  expect_refraction(run);
  EXPECT_EQ(run.events.front().regions_before, (result::Regions{{"left"}}));
  EXPECT_EQ(run.events.front().regions_after, (result::Regions{{"right"}}));
  EXPECT_EQ(run.final.theta, (std::vector<double>{0.0, 1.0}));
}

/// x' = -sign(x) + 0.2 u from 0.4, u = 1 then -2: at the surface from t = 1/2 on, alpha = 0.6, then 0.3. Of two
/// controls and two outputs the second ones belong to the problem.
TEST(OptimizedRunTest, SlidingWithControls) {
  Builder model("sliding");
  const SX state = model.state("x", {0.4}), u = model.control("u", {}), slack = model.control("slack", {});
  model.dynamics("x", 0.2 * u - model.sign(state) + slack);
  model.output("effort", u * u);
  model.output("cost", state);
  Ocp ocp = problem_of(model, 2.0);
  ocp.user_controls = ocp.user_outputs = ocp.problem_outputs = 1;
  const auto x = [](double t) { return vector({std::max(0.4 - 0.8 * t, 0.0)}); };
  const auto lambda = [&](double t) { return sides(x(t)[0]); };
  const auto alpha = [](double value) { return [value](double) { return vector({value}); }; };
  OcpSolution solution;
  solution.horizon = 2.0;
  solution.controls = {{1.0, 0.0}, {-2.0, 0.0}};
  solution.speed_of_time = {1.0, 1.0};
  solution.initial_state = {0.4};
  solution.elements = {{element(0.0, 0.5, {x, alpha(1.0), lambda}), element(0.5, 0.5, {x, alpha(0.6), lambda})},
                       {element(1.0, 1.0, {x, alpha(0.3), lambda})}};
  const auto run = run_of(ocp, solution);
  const auto& rows = run.trajectory;
  expect_near(rows.t, {0.0, 0.5 / 3, 0.5, 0.5, 0.5 + 0.5 / 3, 1.0, 1.0, 1.0 + 1.0 / 3, 2.0});
  expect_near(column(rows.alpha, 0), {1, 1, 1, 0.6, 0.6, 0.6, 0.3, 0.3, 0.3});
  EXPECT_EQ(rows.u, (result::Table<double>{{1}, {1}, {1}, {1}, {1}, {1}, {-2}, {-2}, {-2}}));
  EXPECT_EQ(rows.outputs, (result::Table<double>{{1}, {1}, {1}, {1}, {1}, {1}, {4}, {4}, {4}}));
  ASSERT_EQ(run.events.size(), 1U);
  EXPECT_EQ(run.events.front().kind, EventKind::enter_sliding);
  EXPECT_EQ(run.events.front().t, 0.5);
  EXPECT_EQ(run.final.mode, result::Mode{0});
  EXPECT_EQ(run.final.outputs, std::vector<double>{4.0});
  EXPECT_EQ(run.path.controls, solution.controls);
}

/// x' = 1 - step(x) from -1/2, then x = 0 with alpha = 1: both sides of a pair are zero, but for the solver's error.
TEST(OptimizedRunTest, OnASurfaceWithTheSelectionAtItsBound) {
  Builder model("arriving");
  const SX state = model.state("x", {-0.5});
  model.dynamics("x", 1 - model.step(state, "above"));
  const auto x = [](double t) { return vector({std::min(t - 0.5, 0.0)}); };
  const auto solved = [&](double alpha, double lambda) {
    return Exact{x, [=](double) { return vector({alpha}); },
                 [=](double t) {
                   return vector({std::max(0.5 - t, 0.0), lambda});
                 }};
  };
  OcpSolution solution;
  solution.horizon = 2.0;
  solution.controls = {{}};
  solution.speed_of_time = {1.0};
  solution.initial_state = {-0.5};
  solution.elements = {{element(0.0, 0.5, solved(0.0, 0.0)), element(0.5, 0.5, solved(1.0 - 1e-9, 1e-10)),
                        element(1.0, 0.5, solved(1.0 - 1e-10, 1e-9)), element(1.5, 0.5, solved(1.0 - 1e-9, 1e-10))}};
  const auto run = run_of(problem_of(model, 2.0), solution);
  ASSERT_EQ(run.events.size(), 1U);
  EXPECT_EQ(run.events.front().kind, EventKind::enter_sliding);
  EXPECT_EQ(run.final.mode, result::Mode{0});
}

/// Runs that are stopped leave points anywhere, from which tables are drawn all the same.
TEST(OptimizedRunTest, PointsThatAreNoSolutions) {
  Builder model("geared car");
  const SX t = model.time(), v = model.state("v", {0.0}), u = model.control("u", {2.0, -5.0, 5.0});
  model.dynamics("v", u * (1 + 2 * model.step(v - 1, "gear")) + model.floor(t));
  model.output("effort", u * u);
  const Ocp ocp = problem_of(model, 2.0);
  for (const auto form : {reformulation::Form::step, reformulation::Form::stewart}) {
    const auto dcs = reformulation::reformulate(ocp.system, {form, 2});
    ASSERT_TRUE(dcs.has_value());
    const auto kernel = discretization::OcpKernel::compile(ocp, *dcs, radau(), {});
    ASSERT_TRUE(kernel.has_value()) << to_text(kernel.error());
    const auto problem = discretization::OcpProblem::make(*kernel, ocp, *dcs, {3, 3});
    ASSERT_TRUE(problem.has_value()) << to_text(problem.error());
    discretization::OcpGuessValues guess;
    guess.horizon = 2.0;
    guess.controls = {{2.0}, {-1.0}};
    guess.initial_state = {0.0};
    guess.states.assign((*problem)->start_fractions().size(), {0.5});
    (*problem)->set_start(guess);
    const Vector start = (*problem)->start();
    const auto run = run_of(ocp, (*problem)->read(start), form);
    EXPECT_EQ(run.elements.t.size(), 6U * 4U);
    EXPECT_EQ(run.final.t, 2.0);
    EXPECT_EQ(run.trajectory.u.front(), std::vector<double>{2.0});
    EXPECT_EQ(run.trajectory.u.back(), std::vector<double>{-1.0});
    const Vector nowhere = Vector::constant(start.size(), std::nan(""));
    EXPECT_FALSE(run_of(ocp, (*problem)->read(nowhere), form).trajectory.t.empty());
  }
}

TEST(OptimizedRunTest, StartsOnASurface) {
  Builder model("unstable");
  const SX state = model.state("x", {0.0});
  model.dynamics("x", model.sign(state));
  OcpSolution solution;
  solution.horizon = 1.0;
  solution.controls = {{}};
  solution.speed_of_time = {1.0};
  solution.initial_state = {0.0};
  const Exact down{[](double t) { return vector({-t}); }, [](double) { return vector({0.0}); },
                   [](double t) { return sides(-t); }};
  solution.elements = {{element(0.0, 1.0, down)}};
  const auto run = run_of(problem_of(model, 1.0), solution);
  ASSERT_EQ(run.events.size(), 1U);
  EXPECT_EQ(run.events.front().kind, EventKind::start);
  EXPECT_EQ(run.events.front().mode_after, result::Mode{-1});
  EXPECT_EQ(run.events.front().unique, std::nullopt);
}

/// q falls to 0 at t = 1 with v = -1; below it the clock stands for half a unit of time, until v = 1.
TEST(OptimizedRunTest, TimeFrozenByHand) {
  Builder model("bouncing");
  const SX q = model.state("q", {1.0}), v = model.state("v", {-1.0});
  model.state("clock", {0.0});
  const SX above = model.step(q, "above");
  model.dynamics("q", v);
  model.dynamics("v", 4 * (1 - above));
  model.dynamics("clock", above);
  Ocp ocp = problem_of(model, 2.0);
  ocp.clock = model::OcpClock{2, 1.0, 2.0};
  const auto x = [](double t) {
    const double s = std::clamp(t - 1.0, 0.0, 0.5);
    const double free = std::min(t, 1.0) + std::max(t - 1.5, 0.0);
    return vector({t < 1.5 ? 1.0 - std::min(t, 1.0) - s + 2 * s * s : t - 1.5, -1.0 + 4 * s, free});
  };
  const auto lambda = [&](double t) { return sides(x(t)[0]); };
  const Exact moving{x, [](double) { return vector({1.0}); }, lambda};
  const Exact frozen{x, [](double) { return vector({0.0}); }, lambda};
  OcpSolution solution;
  solution.horizon = 2.0;
  solution.controls = {{}};
  solution.speed_of_time = {1.25};
  solution.initial_state = {1.0, -1.0, 0.0};
  solution.elements = {{element(0.0, 1.0, moving), element(1.0, 0.5, frozen), element(1.5, 1.0, moving)}};
  const auto run = run_of(ocp, solution);
  expect_near(run.trajectory.t, {0.0, 1.0 / 3, 1.0, 1.0, 4.0 / 3, 2.0});
  EXPECT_EQ(run.trajectory.t[2], run.trajectory.t[3]);
  expect_near(column(run.trajectory.x, 1), {-1, -1, -1, 1, 1, 1});
  EXPECT_TRUE(run.events.empty());
  EXPECT_NEAR(run.final.t, 2.0, rounding_error);
  expect_near(run.elements.t, {0, 1.0 / 3, 1, 1, 1, 1, 1, 1, 1, 4.0 / 3, 2, 2});
  EXPECT_EQ(run.path.times, (std::vector<double>{0.0, 2.5}));
  ASSERT_EQ(run.path.events.size(), 2U);
  EXPECT_EQ(run.path.events[0].t, 1.0);
  EXPECT_EQ(run.path.events[1].t, 1.5);
  EXPECT_EQ(run.path.events[1].mode_after, result::Mode{1});
}

}  // namespace
}  // namespace saltus::pipeline
