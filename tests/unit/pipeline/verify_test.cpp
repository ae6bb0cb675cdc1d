// Optimised trajectories simulated again: closed forms, falsified in one place each.
#include "saltus/pipeline/optimal_control/verify.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "ocp_problem.hpp"
#include "saltus/evaluation/model_kernel.hpp"
#include "saltus/event_integrator/integrate.hpp"

namespace saltus::pipeline {
namespace {

using casadi::SX;
using model::Builder;
using model::Ocp;
using result::Termination;
using result::Verification;

/// Tolerances of the simulation are 1e-10, and fields here are polynomials.
constexpr double exact = 1e-10;

/// A trajectory with nodes at equal distances; ranges are those of the nodes.
OptimizedPath path_of(double horizon, std::vector<std::vector<double>> nodes,
                      std::vector<std::vector<double>> controls) {
  OptimizedPath path;
  path.horizon = horizon;
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    path.times.push_back(static_cast<double>(k) * horizon / static_cast<double>(nodes.size() - 1));
  }
  path.state_max = path.state_min = nodes.front();
  for (const auto& node : nodes) {
    for (std::size_t i = 0; i < node.size(); ++i) {
      path.state_max[i] = std::max(path.state_max[i], node[i]);
      path.state_min[i] = std::min(path.state_min[i], node[i]);
    }
  }
  path.nodes = std::move(nodes);
  path.controls = std::move(controls);
  return path;
}

result::Event crossing(double t, int before, int after) {
  result::Event event;
  event.t = t;
  event.mode_before = result::Mode{before};
  event.mode_after = result::Mode{after};
  return event;
}

Verification verified(const Ocp& ocp, const OptimizedPath& path) {
  const auto verification = verify(ocp, path, {1e-3}, {});
  EXPECT_TRUE(verification.has_value()) << (verification ? "" : to_text(verification.error()));
  return verification ? *verification : Verification{};
}

/// x' = 2 - sign(x) from -1: x = -1 + 3 t until t = 1/3, then t - 1/3.
Ocp refraction() {
  Builder model("refraction");
  const SX x = model.state("x", {-1.0});
  model.dynamics("x", 2 - model.sign(x));
  model.output("end", x);
  Ocp ocp = problem_of(model, 1.0);
  ocp.terminal = {constraint(0, 0.5, 0.5)};
  return ocp;
}
OptimizedPath refracted() {
  auto path = path_of(1.0, {{-1.0}, {-0.25}, {0.5 - 1.0 / 3.0}, {0.75 - 1.0 / 3.0}, {2.0 / 3.0}}, {{}, {}, {}, {}});
  path.events = {crossing(1.0 / 3.0, -1, 1)};
  return path;
}

TEST(VerifyTest, ExactTrajectories) {
  const auto found = verified(refraction(), refracted());
  EXPECT_EQ(found.tolerance, 1e-3);
  EXPECT_LT(found.interval_defect, exact);
  EXPECT_LT(found.switch_time_error, exact);
  EXPECT_EQ(found.switches_missed, 0);
  EXPECT_EQ(found.switches_extra, 0);
  EXPECT_EQ(found.path_violation, 0.0);
  EXPECT_EQ(found.message, "");
  EXPECT_EQ(found.open_loop.termination, Termination::completed);
  EXPECT_LT(found.open_loop.end_state_error, exact);
  EXPECT_NEAR(found.open_loop.terminal_violation, 2.0 / 3.0 - 0.5, exact);
  // d x(T)/d x(0) = f(after)/f(before); differences of runs to 1e-10 in steps of 1e-5 are known to 1e-5.
  EXPECT_NEAR(found.open_loop.amplification, 1.0 / 3.0, 1e-5);
  ASSERT_GE(found.open_loop.t.size(), 200U);
  EXPECT_EQ(found.open_loop.t.size(), found.open_loop.x.size());
  EXPECT_EQ(found.open_loop.t.front(), 0.0);
  EXPECT_EQ(found.open_loop.t.back(), 1.0);
}

TEST(VerifyTest, DefectsAreRelativeToTheRange) {
  auto path = refracted();
  path.nodes[4][0] += 0.01;
  const auto found = verified(refraction(), path);
  EXPECT_NEAR(found.interval_defect, 0.01 / (5.0 / 3.0), exact);
  EXPECT_EQ(found.interval, 3);
  EXPECT_EQ(found.state, "x");
}

TEST(VerifyTest, DefectsOfConstantStatesAreRelativeToTheirBounds) {
  Builder model("constant");
  model.state("x", {0.0, -20.0, 10.0});
  model.dynamics("x", 0);
  const Ocp ocp = problem_of(model, 1.0);
  auto path = path_of(1.0, {{0.0}, {1e-3}}, {{}});
  path.state_max = {0.0};
  EXPECT_NEAR(verified(ocp, path).interval_defect, 1e-3 / 20e-3, exact);
}

TEST(VerifyTest, MissedAndExtraSwitches) {
  auto path = refracted();
  path.events.clear();
  auto found = verified(refraction(), path);
  EXPECT_EQ(found.switches_missed, 1);
  EXPECT_EQ(found.switches_extra, 0);
  path.events = {crossing(0.34, -1, 1), crossing(0.6, 1, -1)};
  found = verified(refraction(), path);
  EXPECT_EQ(found.switches_missed, 0);
  EXPECT_EQ(found.switches_extra, 1);
  EXPECT_NEAR(found.switch_time_error, 0.34 - 1.0 / 3.0, exact);
}

TEST(VerifyTest, SwitchesAtEndsOfIntervals) {
  auto path = path_of(1.0, {{-1.0}, {0.0}, {1.0 / 3.0}, {2.0 / 3.0}}, {{}, {}, {}});
  path.events = {crossing(1.0 / 3.0, -1, 1)};
  const auto found = verified(refraction(), path);
  EXPECT_LT(found.interval_defect, exact);
  EXPECT_EQ(found.switches_missed, 0);
  EXPECT_EQ(found.switches_extra, 0);
}

Ocp turbo_car() {
  Builder model("turbo car");
  model.state("q", {0.0});
  const SX v = model.state("v", {0.0, 0.0, 25.0});
  const SX u = model.control("u", {0.0, -5.0, 5.0});
  model.dynamics("q", v);
  model.dynamics("v", u * (1 + 2 * model.step(v - 10, "turbo")));
  return problem_of(model, 4.0);
}

TEST(VerifyTest, ControlsOfIntervals) {
  // u = 4: v = 10 at t = 2.5, then v' = 12; u = -1 at the end: v' = -3.
  auto path = path_of(4.0, {{0.0, 0.0}, {2.0, 4.0}, {8.0, 8.0}, {19.0, 16.0}, {33.5, 13.0}}, {{4}, {4}, {4}, {-1}});
  path.events = {crossing(2.5, -1, 1)};
  const auto found = verified(turbo_car(), path);
  EXPECT_LT(found.interval_defect, exact);
  EXPECT_LT(found.open_loop.end_state_error, exact);
  EXPECT_LT(found.switch_time_error, exact);
  EXPECT_EQ(found.switches_missed + found.switches_extra, 0);
  path.controls[3] = {-1.5};
  const auto other = verified(turbo_car(), path);
  EXPECT_NEAR(other.interval_defect, 1.5 / 16.0, exact);
  EXPECT_EQ(other.interval, 3);
  EXPECT_EQ(other.state, "v");
}

TEST(VerifyTest, ViolationsBetweenNodes) {
  // q = t - t^2: 0 at both nodes, 1/4 between them.
  Builder model("ballistic");
  const SX q = model.state("q", {0.0, -infinity, 0.25}), v = model.state("v", {1.0});
  const SX u = model.control("u", {});
  model.dynamics("q", v);
  model.dynamics("v", u);
  model.output("height", q);
  Ocp ocp = problem_of(model, 1.0);
  const auto path = path_of(1.0, {{0.0, 1.0}, {0.0, -1.0}}, {{-2.0}});
  EXPECT_NEAR(verified(ocp, path).path_violation, 0.0, exact);
  ocp.path = {constraint(0, -infinity, 0.2)};
  EXPECT_NEAR(verified(ocp, path).path_violation, 0.05, exact);
  const auto named = verified(ocp, path).path_violations;
  ASSERT_EQ(named.size(), 1U);
  EXPECT_EQ(named[0].name, ocp.path[0].name);
  EXPECT_NEAR(named[0].time, 0.5, exact);
  EXPECT_NEAR(named[0].value, 0.05, exact);
  EXPECT_NEAR(named[0].share, 0.2, exact);       // of 1/4
  ocp.path[0].norm = model::ConstraintNorm::l1;  // soft
  EXPECT_NEAR(verified(ocp, path).path_violation, 0.0, exact);
  EXPECT_TRUE(verified(ocp, path).path_violations.empty());
  ocp.system.state_upper[0] = 0.125;
  EXPECT_NEAR(verified(ocp, path).path_violation, 0.125, exact);
  EXPECT_EQ(verified(ocp, path).path_violations.at(0).name, "q");
}

TEST(VerifyTest, ParametersOfTheSolution) {
  Builder model("decay");
  const SX rate = model.parameter("rate", 1.0), x = model.state("x", {1.0});
  model.dynamics("x", -rate * x);
  const Ocp ocp = problem_of(model, 1.0);
  auto path = path_of(1.0, {{1.0}, {std::exp(-2.0)}}, {{}});
  path.parameters = {2.0};
  EXPECT_LT(verified(ocp, path).interval_defect, 1e-9);
}

TEST(VerifyTest, IntervalsThatCannotBeSimulated) {
  Builder model("root");
  const SX x = model.state("x", {0.5}), y = model.state("y", {0.0});
  model.dynamics("x", -1);
  model.dynamics("y", sqrt(x));
  const auto found = verified(problem_of(model, 2.0), path_of(2.0, {{1.25, 0.0}, {0.25, 0.0}, {-0.75, 0.0}}, {{}, {}}));
  EXPECT_TRUE(std::isnan(found.interval_defect));
  EXPECT_EQ(found.interval, 1);
  EXPECT_NE(found.message.find("interval 1 cannot be simulated: evaluation_failed"), std::string::npos)
      << found.message;
  EXPECT_NE(found.open_loop.termination, Termination::completed);
  EXPECT_TRUE(std::isnan(found.open_loop.end_state_error));
  EXPECT_FALSE(found.open_loop.t.empty());
}

/// x' = sign(x) from 0 has many solutions.
TEST(VerifyTest, TheModeOfTheSolutionWhereThereAreSeveral) {
  Builder model("unstable");
  const SX x = model.state("x", {0.0});
  model.dynamics("x", model.sign(x));
  const Ocp ocp = problem_of(model, 1.0);
  for (const int mode : {-1, 1}) {
    auto path = path_of(1.0, {{0.0}, {0.5 * mode}, {1.0 * mode}}, {{}, {}});
    result::Event start;
    start.mode_after = result::Mode{mode};
    path.events = {start};
    const auto found = verified(ocp, path);
    EXPECT_LT(found.interval_defect, exact) << mode << found.message;
    EXPECT_LT(found.open_loop.end_state_error, exact) << mode;
    EXPECT_EQ(found.switches_missed + found.switches_extra, 0);
  }
  auto staying = path_of(1.0, {{0.0}, {0.0}}, {{}});
  result::Event start;
  start.mode_after = result::Mode{0};
  staying.events = {start};
  EXPECT_LT(verified(ocp, staying).interval_defect, exact);
}

/// x' = sign(x) may stay at 0 as long as it wants.
TEST(VerifyTest, ExitsOfTheSolutionFromASurfaceThatRepels) {
  Builder model("unstable");
  const SX x = model.state("x", {0.0});
  model.dynamics("x", model.sign(x));
  const Ocp ocp = problem_of(model, 2.0);
  for (const int mode : {-1, 1}) {
    auto path = path_of(2.0, {{0.0}, {0.25 * mode}, {1.25 * mode}}, {{}, {}});
    result::Event start;
    start.mode_after = result::Mode{0};
    path.events = {start, crossing(0.75, 0, mode)};
    const auto found = verified(ocp, path);
    EXPECT_LT(found.interval_defect, exact) << mode << found.message;
    EXPECT_LT(found.open_loop.end_state_error, exact) << mode;
    EXPECT_LT(found.switch_time_error, exact);
    EXPECT_EQ(found.switches_missed + found.switches_extra, 0);
  }
}

/// a' = -sign(b), b' = -sign(a) from (1, 1): at t = 1 both are zero. They may stay there, or leave to either side: a
/// motion that meets one surface first never comes to the other.
TEST(VerifyTest, TwoSurfacesThatTheSolutionMeetsAtOnce) {
  Builder model("meets");
  const SX a = model.state("a", {1.0}), b = model.state("b", {1.0});
  model.dynamics("a", -model.sign(b));
  model.dynamics("b", -model.sign(a));
  auto path = path_of(2.0, {{1.0, 1.0}, {0.0, 0.0}}, {{}});
  result::Event event;
  event.t = 1.0;
  event.mode_before = result::Mode{1, 1};
  event.mode_after = result::Mode{0, 0};
  path.events = {event};
  path.elements = {{0.0, 0, {1.0, 1.0}}, {1.0, 0, {0.0, 0.0}}};
  const auto found = verified(problem_of(model, 2.0), path);
  EXPECT_LT(found.interval_defect, exact);
  EXPECT_EQ(found.switches_missed + found.switches_extra, 0);
  EXPECT_NE(found.message.find("not unique in interval 0"), std::string::npos) << found.message;
  // What it was moved by there counts.
  path.elements.back().x = {0.0, 0.01};
  EXPECT_GT(verified(problem_of(model, 2.0), path).interval_defect, 0.009);
}

/// v' = sign(v): nodes are a rounding beside the surface that the solution stays on.
TEST(VerifyTest, NodesARoundingBesideASurfaceThatRepels) {
  Builder model("repels");
  const SX v = model.state("v", {0.0});
  model.dynamics("v", model.sign(v));
  auto path = path_of(2.0, {{0.0}, {1e-24}, {-1e-20}}, {{}, {}});
  path.state_max = {1.0};
  result::Event event;
  event.mode_after = result::Mode{0};
  path.events = {event};
  EXPECT_LT(verified(problem_of(model, 2.0), path).interval_defect, exact);
}

TEST(VerifyTest, NodesBesideASurfaceOnWhichTheSolutionSlides) {
  // x' = 1/2 - sign(x) from 1/4: on the surface from t = 1/2 on.
  Builder model("sliding");
  const SX x = model.state("x", {0.25});
  model.dynamics("x", 0.5 - model.sign(x));
  auto path = path_of(3.0, {{0.25}, {1e-9}, {-1e-9}, {0.0}}, {{}, {}, {}});
  path.events = {crossing(0.5, 1, 0)};
  const auto found = verified(problem_of(model, 3.0), path);
  EXPECT_LT(found.interval_defect, 1e-8);
  EXPECT_LT(found.switch_time_error, exact);
  EXPECT_EQ(found.switches_missed + found.switches_extra, 0);
}

/// Of two regions, by indicator: x' = 3 where -x is the larger one, else 1, as refraction().
TEST(VerifyTest, SwitchesOfRegions) {
  Builder model("regions");
  const SX x = model.state("x", {-1.0});
  model.region(x, {{"x", 3}}, "left");
  model.region(-x, {{"x", 1}}, "right");
  auto path = refracted();
  path.events.front().mode_before = path.events.front().mode_after = result::Mode{};
  path.events.front().regions_before = result::Regions{{"left"}};
  path.events.front().regions_after = result::Regions{{"right"}};
  const Ocp ocp = problem_of(model, 1.0);
  auto found = verified(ocp, path);
  EXPECT_LT(found.interval_defect, exact);
  EXPECT_LT(found.switch_time_error, exact);
  EXPECT_EQ(found.switches_missed + found.switches_extra, 0);
  path.events.clear();
  found = verified(ocp, path);
  EXPECT_EQ(found.switches_missed, 1);
}

/// A sliding mode that the input breaks off, and starts again.
Builder rubbed() {
  Builder model("rubbed");
  const SX q = model.state("q", {0.3}), v = model.state("v", {0.1});
  const SX u = model.control("u", {0.5});
  model.dynamics("q", v);
  model.dynamics("v", -q + u - 0.4 * model.sign(v));
  return model;
}

event_integrator::Integration simulated(const model::System& system) {
  auto kernel = evaluation::ModelKernel::compile(system);
  EXPECT_TRUE(kernel.has_value());
  event_integrator::IntegrationOptions options;
  options.until = 4.0;
  return event_integrator::integrate(*kernel, options);
}

TEST(VerifyTest, ControlsActAsSampledInputs) {
  const std::vector<double> times{0.0, 1.0, 2.0, 3.0};
  Builder plain = rubbed(), sampled = rubbed();
  sampled.input("u", times, {0.5, -0.7, -0.7, 1.5});
  const auto run = simulated(model::with_controls(*plain.build(), times, {{0.5}, {-0.7}, {-0.7}, {1.5}}));
  const auto expected = simulated(*sampled.build());
  EXPECT_EQ(run.trajectory.t, expected.trajectory.t);
  EXPECT_EQ(run.trajectory.x, expected.trajectory.x);
  EXPECT_EQ(run.trajectory.u, expected.trajectory.u);
  EXPECT_EQ(run.trajectory.alpha, expected.trajectory.alpha);
  EXPECT_EQ(run.events.size(), expected.events.size());
  EXPECT_GE(run.events.size(), 3U);
}

TEST(VerifyTest, CanBeInterrupted) {
  const auto found = verify(refraction(), refracted(), {1e-3}, [] { return true; });
  ASSERT_TRUE(found.has_value());
  EXPECT_TRUE(std::isnan(found->interval_defect));
  EXPECT_EQ(found->open_loop.termination, Termination::stopped_by_user);
  EXPECT_FALSE(found->message.empty());
}

TEST(VerifyTest, EventsOfTheUserDoNotStop) {
  Builder model("stops");
  const SX x = model.state("x", {0.0});
  model.dynamics("x", 1);
  model.event(x - 0.5, {.action = model::AtEvent::stop});
  const auto found = verified(problem_of(model, 1.0), path_of(1.0, {{0.0}, {1.0}}, {{}}));
  EXPECT_LT(found.interval_defect, exact);
}

}  // namespace
}  // namespace saltus::pipeline
