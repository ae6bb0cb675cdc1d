// method = "smoothed" against closed forms, published values and the event engine, and the shape of its results.
#include <algorithm>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "problems/references.hpp"
#include "problems/simulator.hpp"

namespace saltus::problems {
namespace {

using pipeline::SimulateOptions;
using result::Result;
using result::Termination;

Result run_smoothed(const Simulator& model, double epsilon) {
  SimulateOptions options = model.options();
  options.method = pipeline::Method::smoothed;
  options.smoothed.epsilon = epsilon;
  Result result = model.run(options);
  EXPECT_EQ(result.status.termination, Termination::completed) << result.status.message;
  return result;
}

/// Acary, de Jong, Brogliato, Physica D 269 (2014) 103: both surfaces x1 = 8 and x2 = 8 hold the solution in the end.
constexpr const char* two_genes = R"toml([model]
name = "two-genes"
[states]
x1 = 6
x2 = 6
[switching]
x1_high = "x1 - 8"
x2_high = "x2 - 8"
[dynamics]
x1 = "-4.5*x1 + 40*(1 - step(x1_high))*step(x2 - 4)"
x2 = "-1.5*x2 + 40*step(x1 - 4)*(1 - step(x2_high))"
[simulate]
until = 1
)toml";

/// Three surfaces whose normal components depend on all selections, reached one after the other; y4 integrates what the
/// selections are.
constexpr const char* three_coupled = R"toml([model]
name = "three-coupled"
[states]
y1 = -0.3
y2 = 0.2
y3 = -0.1
y4 = 0
[dynamics]
y1 = "t/2 - sign(y1) + (sign(y2) + sign(y3))/4 + sign(y1)*sign(y2)*sign(y3)/8"
y2 = "y4/8 - sign(y2) + (sign(y1) + sign(y3))/4"
y3 = "-sign(y3) + (sign(y1) + sign(y2))/4 - sign(y1)*sign(y2)/8"
y4 = "sign(y1)*sign(y2) + sign(y3)"
[simulate]
until = 1.5
rtol = 1e-11
atol = 1e-13
)toml";

// The event engine's sliding in codimension 3 is the limit: the difference falls like epsilon.
TEST(SmoothedRun, TendsToSlidingOnThreeCoupledSurfaces) {
  const Simulator model = Simulator::from_text(three_coupled);
  const Result sharp = model.run(model.options());
  ASSERT_EQ(sharp.status.termination, Termination::completed) << sharp.status.message;
  ASSERT_EQ(sharp.final.mode, (result::Mode{0, 0, 0}));
  ASSERT_EQ(sharp.events.size(), 3U);
  const auto difference = [&](double epsilon) {
    const Result result = run_smoothed(model, epsilon);
    for (std::size_t j = 0; j < 3; ++j) EXPECT_NEAR(result.final.alpha[j], sharp.final.alpha[j], epsilon) << j;
    return std::abs(result.final.x[3] - sharp.final.x[3]);
  };
  const double coarse = difference(1e-3), fine_one = difference(1e-4);
  EXPECT_LT(coarse, 3e-3);
  EXPECT_NEAR(coarse / fine_one, 10.0, 0.3);
}

TEST(SmoothedRun, HoldsTheIntersectionOfTwoSurfaces) {
  const Simulator model = Simulator::from_text(two_genes);
  for (const double epsilon : {1e-3, 1e-5}) {
    const Result result = run_smoothed(model, epsilon);
    ASSERT_EQ(result.events.size(), 2u);
    EXPECT_EQ(result.events[0].surfaces, std::vector<std::string>{"x2_high"});
    EXPECT_EQ(result.events[1].surfaces, std::vector<std::string>{"x1_high"});
    EXPECT_NEAR(result.events[0].t, 0.0678551295400, epsilon);
    EXPECT_NEAR(result.events[1].t, 0.2619233325203, epsilon);
    EXPECT_NEAR(result.final.x[0], 8.0, epsilon);
    EXPECT_NEAR(result.final.x[1], 8.0, epsilon);
    // at rest: 40 (1 - alpha) = 4.5 * 8 and 1.5 * 8
    EXPECT_NEAR(result.final.alpha[0], 0.1, epsilon);
    EXPECT_NEAR(result.final.alpha[1], 0.7, epsilon);
    EXPECT_EQ(result.final.mode, (result::Mode{0, 0, 1, 1}));
  }
}

// Cycles that contract until the layers are reached say nothing about the steps behind them: a million was not enough.
TEST(SmoothedRun, ASpiralThatEndsInItsLayersGoesOnWithTheTolerancesOfTheRun) {
  const Result result = run_smoothed(Simulator::from_catalogue("slow-spiral"), 1e-4);
  EXPECT_NEAR(result.final.x[0], 0.0, 1e-4);
  EXPECT_NEAR(result.final.x[1], 0.0, 1e-4);
  EXPECT_LT(result.statistics.steps, 20000);
}

TEST(SmoothedRun, RowsAreWhatTheDefinitionSays) {
  const double epsilon = 1e-4;
  const Result result = run_smoothed(Simulator::from_catalogue("stick-slip"), epsilon);
  const auto& rows = result.trajectory;
  ASSERT_GT(rows.t.size(), 1000u);
  for (std::size_t i = 0; i < rows.t.size(); ++i) {
    const double psi = rows.x[i][1] - 0.2;
    EXPECT_NEAR(rows.alpha[i][0], std::clamp((psi / epsilon + 1.0) / 2.0, 0.0, 1.0), 1e-9) << rows.t[i];
    const double beyond = std::abs(psi) - epsilon;
    if (std::abs(beyond) < 1e-12) continue;  // on an edge
    EXPECT_EQ(rows.mode[i][0], beyond < 0.0 ? 0 : psi > 0.0 ? 1 : -1) << rows.t[i];
  }
  for (const auto& event : result.events) {
    EXPECT_EQ(std::count(rows.t.begin(), rows.t.end(), event.t), 2);
    EXPECT_NEAR(std::abs(event.x[1] - 0.2), epsilon, 1e-14);
    EXPECT_EQ(event.unique, true);
    ASSERT_TRUE(event.alpha_before && event.alpha_after);
    EXPECT_NEAR(event.alpha_before->front(), event.alpha_after->front(), 1e-9);
  }
}

TEST(SmoothedRun, ConvergesWithOrderOneToSlidingOnThreeCoupledSurfaces) {
  // Each velocity depends on all selections and on products of them; w sees the moving root.
  const Simulator model = Simulator::from_text(R"toml([model]
name = "three-coupled"
[states]
x = 1
y = 0.8
z = 0.9
w = 0
[definitions]
a = "sign(x)"
b = "sign(y)"
c = "sign(z)"
[dynamics]
x = "-a + 0.4*b - 0.3*c + 0.2*b*c + 0.3*sin(t)"
y = "-0.5*a - b + 0.3*c + 0.2*a*c + 0.2*cos(2*t)"
z = "0.3*a - 0.4*b - c + 0.3*a*b - 0.2*t"
w = "a + 2*b*c + a*b*c - w"
[simulate]
until = 3
rtol = 1e-10
)toml");
  const Result exact = model.run(model.options());
  ASSERT_EQ(exact.status.termination, Termination::completed) << exact.status.message;
  ASSERT_EQ(exact.final.mode, (result::Mode{0, 0, 0}));
  ASSERT_EQ(exact.events.size(), 3u);
  double previous = 0.0;
  for (const double epsilon : {1e-3, 1e-4, 1e-5}) {
    const Result smooth = run_smoothed(model, epsilon);
    const double error = std::abs(smooth.final.x[3] - exact.final.x[3]);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(smooth.final.alpha[i], exact.final.alpha[i], epsilon);
    if (previous > 0.0) {
      EXPECT_NEAR(std::log10(previous / error), 1.0, 0.02) << epsilon;
    }
    previous = error;
  }
}

TEST(SmoothedRun, NestedFunctionsHaveTheLimitOfTheEventEngine) {
  // x slides with alpha = 0.6; around it step(y - step(x)) is read on both sides: y' = 0.6 - 0.4 for 0 < y < 1.
  const Simulator model = Simulator::from_text(R"toml([model]
name = "nested"
[states]
x = 0
y = 0.25
[dynamics]
x = "-sign(x) + 0.2"
y = "1 - 2*step(y - step(x))"
[simulate]
until = 1.5
)toml");
  const Result exact = model.run(model.options());
  ASSERT_EQ(exact.status.termination, Termination::completed) << exact.status.message;
  EXPECT_NEAR(exact.final.x[1], 0.25 + 0.2 * 1.5, 1e-12);
  double previous = 1.0;
  for (const double epsilon : {1e-2, 1e-3, 1e-4, 1e-5}) {
    const double error = std::abs(run_smoothed(model, epsilon).final.x[1] - exact.final.x[1]);
    EXPECT_LT(error, 3 * epsilon);
    EXPECT_LT(error, previous);
    previous = error;
  }
}

TEST(SmoothedRun, InclusionsHaveTheirOwnLimits) {
  const auto text = [](const std::string& inclusion) {
    return "[model]\nname = \"product\"\ninclusion = \"" + inclusion +
           "\"\n[states]\nx = 0.1\ny = 0\n[dynamics]\nx = \"-0.5 - 2*step(x) + 1.5\"\n"
           "y = \"(1 + 3*step(x))*(2*step(x) - 1)\"\n[simulate]\nuntil = 1\n";
  };
  for (const char* inclusion : {"filippov", "aizerman_pyatnitskii"}) {
    const Simulator model = Simulator::from_text(text(inclusion));
    const Result exact = model.run(model.options());
    ASSERT_EQ(exact.status.termination, Termination::completed) << exact.status.message;
    EXPECT_NEAR(run_smoothed(model, 1e-6).final.x[1], exact.final.x[1], 1e-5) << inclusion;
  }
}

TEST(SmoothedRun, UserEventsStopItAndKinksStayKinks) {
  const Simulator model = Simulator::from_text(R"toml([model]
name = "stops"
[states]
x = -1
[dynamics]
x = "2 - sign(x) + max(x - 0.25, 0)"
[outputs]
side = "sign(x)"
[[events]]
name = "far"
when = "x > 0.2 and sign(x) > 0.5"
stop = true
[simulate]
until = 3
)toml");
  SimulateOptions options = model.options();
  options.method = pipeline::Method::smoothed;
  const Result result = model.run(options);
  EXPECT_EQ(result.status.termination, Termination::stopped_by_event);
  ASSERT_EQ(result.events.size(), 3u);
  EXPECT_EQ(result.events[2].name, "far");
  EXPECT_EQ(result.events[2].mode_after, (result::Mode{1}));
  EXPECT_NEAR(result.final.t, 1.0 / 3.0 + 0.2, 1e-5);
  ASSERT_EQ(result.outputs.size(), 1u);
  ASSERT_EQ(result.final.outputs.size(), 1u);
  EXPECT_EQ(result.final.outputs[0], 1.0);
}

TEST(SmoothedRun, JumpsAndTheirAccumulationPassThrough) {
  // A bouncing ball beside dry friction, and a jump whose condition reads the selection.
  const Simulator model = Simulator::from_text(R"toml([model]
name = "jumps"
[states]
z = 1
w = 0
x = -1
[dynamics]
z = "w"
w = "-9.8"
x = "1 - 2*sign(x)"
[[jumps]]
name = "bounce"
when = "z"
direction = "down"
set = { w = "-0.5*w" }
[[jumps]]
name = "kick"
when = "step(x) > 0.2 and t > 1"
set = { x = "x - 1" }
[simulate]
until = 1.9
)toml");
  const Result exact = model.run(model.options());
  ASSERT_EQ(exact.status.termination, Termination::completed) << exact.status.message;
  const Result result = run_smoothed(model, 1e-7);
  ASSERT_EQ(result.events.size(), exact.events.size());
  for (std::size_t i = 0; i < exact.events.size(); ++i) {
    EXPECT_EQ(result.events[i].kind, exact.events[i].kind) << i;
    EXPECT_EQ(result.events[i].surfaces, exact.events[i].surfaces) << i;
    EXPECT_NEAR(result.events[i].t, exact.events[i].t, 1e-6) << i;
    EXPECT_EQ(result.events[i].mode_before, exact.events[i].mode_before) << i;
    EXPECT_EQ(result.events[i].mode_after, exact.events[i].mode_after) << i;
  }
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(result.final.x[i], exact.final.x[i], 1e-6) << i;
}

TEST(SmoothedRun, OutputTimesChangeNothing) {
  const Simulator model = Simulator::from_catalogue("friction-blocks");
  SimulateOptions options = model.options();
  options.method = pipeline::Method::smoothed;
  options.output = pipeline::EveryStep{};
  const Result steps = model.run(options);
  options.output = pipeline::NumberOfPoints{17};
  const Result points = model.run(options);
  EXPECT_EQ(points.final.x, steps.final.x);
  EXPECT_EQ(points.final.alpha, steps.final.alpha);
  ASSERT_EQ(points.events.size(), steps.events.size());
  for (std::size_t i = 0; i < steps.events.size(); ++i) EXPECT_EQ(points.events[i].t, steps.events[i].t);
}

TEST(SmoothedRun, ALayerOfRoundingsIsSaidToBeTooThin) {
  const Simulator model = Simulator::from_catalogue("relay-feedback");
  SimulateOptions options = model.options();
  options.method = pipeline::Method::smoothed;
  options.smoothed.epsilon = 1e-15;
  const Result result = model.run(options);
  EXPECT_EQ(result.status.termination, Termination::step_size_too_small);
  EXPECT_NE(result.status.message.find("choose a larger simulate.smoothed.epsilon"), std::string::npos)
      << result.status.message;
}

TEST(SmoothedRun, AStartOnARepellingSurfaceStaysThere) {
  const Result result = run_smoothed(Simulator::from_catalogue("spontaneous-switch"), 1e-6);
  EXPECT_EQ(result.final.x[0], 0.0);
  EXPECT_EQ(result.final.mode, (result::Mode{0}));
  EXPECT_TRUE(result.events.empty());
}

}  // namespace
}  // namespace saltus::problems
