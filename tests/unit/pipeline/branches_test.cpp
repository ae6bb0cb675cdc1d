// Trees of trajectories where the solution is not unique: closed forms, caps, stops, and what a branch takes along.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "saltus/model/builder.hpp"
#include "saltus/pipeline/simulate.hpp"

namespace saltus::pipeline {
namespace {

using casadi::SX;
using model::Builder;
using result::Mode;
using result::Result;
using result::Termination;

Result run(Builder& builder, SimulateOptions options, const Observers& observers = {}) {
  const auto system = builder.build();
  EXPECT_TRUE(system.has_value()) << (system ? "" : system.error().message);
  const auto result = simulate(*system, options, observers);
  EXPECT_TRUE(result.has_value()) << (result ? "" : result.error().message);
  return *result;
}

SimulateOptions until(double end, long trajectories) {
  SimulateOptions options;
  options.until = end;
  options.event.trajectories = trajectories;
  options.native = Native::off;
  return options;
}

/// x' = sgn x from 0: up, down, or staying.
Builder spontaneous() {
  Builder b("spontaneous");
  const SX x = b.state("x", {0});
  b.dynamics("x", b.sign(x));
  return b;
}

TEST(Branches, OfASpontaneousSwitchAreItsThreeSolutions) {
  auto b = spontaneous();
  const Result root = run(b, until(2, 64));
  ASSERT_EQ(root.branches.size(), 2U);
  std::vector<double> ends{root.final.x[0]};
  for (const Result& branch : root.branches) {
    EXPECT_EQ(branch.status.termination, Termination::completed);
    ASSERT_TRUE(branch.left_at.has_value());
    EXPECT_EQ(branch.left_at->event, 0U);
    const auto taken = root.events[0].alternatives[branch.left_at->alternative];
    EXPECT_EQ(*branch.events[0].mode_after, taken.mode);
    EXPECT_EQ(branch.trajectory.mode[1], taken.mode);
    ASSERT_EQ(branch.events[0].alternatives.size(), 2U);
    EXPECT_EQ(branch.events[0].alternatives[0].mode, *root.events[0].mode_after);
    EXPECT_NEAR(branch.final.x[0], 2.0 * branch.events[0].mode_after->front(), 1e-12);
    EXPECT_EQ(result::not_followed(branch), 0U);
    ends.push_back(branch.final.x[0]);
  }
  std::sort(ends.begin(), ends.end());
  EXPECT_NEAR(ends[0], -2, 1e-12);
  EXPECT_EQ(ends[1], 0.0);
  EXPECT_NEAR(ends[2], 2, 1e-12);
  EXPECT_EQ(result::not_followed(root), 0U);
}

TEST(Branches, FromTheStartAreTheRunsThatAreForcedThere) {
  auto b = spontaneous();
  const Result root = run(b, until(2, 64));
  for (const Result& branch : root.branches) {
    auto options = until(2, 1);
    options.initial_mode = {{"x", branch.events[0].mode_after->front()}};
    const Result forced = run(b, options);
    EXPECT_EQ(branch.trajectory.t, forced.trajectory.t);
    EXPECT_EQ(branch.trajectory.x, forced.trajectory.x);
    EXPECT_EQ(branch.statistics.steps, forced.statistics.steps);
  }
}

/// Put back to 0 at given times: the solution splits into three there and at the start.
Builder repeated(const std::vector<double>& times) {
  auto b = spontaneous();
  b.jump_at(times, {{"x", 0}}, {.name = "back"});
  return b;
}

TEST(Branches, AreFollowedBreadthFirstUpToTheCap) {
  auto b = repeated({1, 2});
  std::map<int, int> ends;
  std::size_t deepest = 0;
  const Result all = run(b, until(2.5, 64));
  for (const auto& entry : result::tree(all)) {
    ++ends[static_cast<int>(std::lround(2 * entry.result->final.x[0]))];
    deepest = std::max(deepest, entry.label.size());
    EXPECT_EQ(result::not_followed(*entry.result), 0U) << entry.label;
    for (const auto& event : entry.result->events) EXPECT_EQ(event.alternatives.size(), 2U) << entry.label;
  }
  EXPECT_EQ(ends, (std::map<int, int>{{-1, 9}, {0, 9}, {1, 9}}));
  EXPECT_EQ(deepest, 5U);  // 1.1.1

  const Result some = run(b, until(2.5, 6));
  ASSERT_EQ(some.branches.size(), 5U);
  std::vector<std::size_t> events;
  for (const Result& branch : some.branches) events.push_back(branch.left_at->event);
  EXPECT_EQ(events, (std::vector<std::size_t>{0, 0, 1, 1, 2}));
  EXPECT_EQ(result::not_followed(some), 1U);
  EXPECT_EQ(result::not_followed(some.branches[0]), 4U);
  EXPECT_EQ(result::not_followed(some.branches[4]), 0U);
}

TEST(Branches, TakeAlongWhatWaitsIsHeldOrWasSeen) {
  auto b = repeated({4});
  // Rests on the ground from t = 3 on; a dose that was triggered at t = 3.5 is given at t = 4.5; ticks count from 0.
  const SX z = b.state("z", {0.5});
  const SX v = b.state("v", {0});
  const SX y = b.state("y", {0});
  const SX n = b.discrete_state("n", 0);
  b.dynamics("z", v);
  b.dynamics("v", -1);
  b.dynamics("y", 1 + n);
  b.jump(z, model::Direction::down, {{"v", -0.5 * v}}, {.name = "bounce"});
  b.jump(y - 3.5, model::Direction::up, {{"n", 1}}, {.name = "dose", .delay = 1});
  b.jump_every(1.6, {{"y", y}}, {.name = "tick"});
  b.event(y - 3.75, {.name = "seen"});
  auto options = until(5, 64);
  options.output = AtTimes{{1, 4, 4.25, 5}};
  options.event_rows = true;
  const Result root = run(b, options);
  ASSERT_EQ(root.status.termination, Termination::completed) << root.status.message;
  ASSERT_EQ(root.branches.size(), 4U);
  int later = 0;
  for (const Result& branch : root.branches) {
    if (branch.events[0].t == 0.0) continue;
    ++later;
    ASSERT_EQ(branch.events.size(), 3U);
    EXPECT_EQ(branch.events[0].name, "back");
    EXPECT_EQ(branch.events[0].t, 4.0);
    EXPECT_EQ(branch.events[1].name, "dose");
    EXPECT_NEAR(branch.events[1].t, 4.5, 1e-12);
    EXPECT_EQ(branch.events[2].name, "tick");
    EXPECT_NEAR(branch.events[2].t, 4.8, 1e-15);
    EXPECT_EQ(branch.final.x[1], 0.0);
    EXPECT_EQ(branch.final.x[2], 0.0);
    EXPECT_NEAR(branch.final.x[3], 5.5, 1e-12);
    // Behind every jump the mode is decided afresh: what stays leaves at the dose.
    const int side = branch.events[0].mode_after->front();
    EXPECT_NEAR(branch.final.x[0], side == 0 ? 0.5 : side, 1e-12);
    // Rows: two for every event, the requested times from the event on.
    const auto& t = branch.trajectory.t;
    EXPECT_EQ(t.size(), 8U);
    EXPECT_EQ(t.front(), 4.0);
    EXPECT_EQ(t[1], 4.0);
    EXPECT_EQ(t[2], 4.25);
    EXPECT_EQ(t.back(), 5.0);
    EXPECT_EQ(branch.trajectory.x[1], branch.events[0].x_after);
  }
  EXPECT_EQ(later, 2);
}

/// A field that depends on time and on another state.
Builder driven(double x0, double y0) {
  Builder b("driven");
  const SX x = b.state("x", {x0});
  const SX y = b.state("y", {y0});
  b.dynamics("x", b.sign(x) * (1 + y + SX::sin(3 * b.time())) - b.sign(x - 0.5) * y);
  b.dynamics("y", -x * y);
  return b;
}

TEST(Branches, AreTheFreshRunsFromTheirEvents) {
  auto b = driven(0.25, 1);
  b.jump_at({1}, {{"x", 0}});
  const Result root = run(b, until(3, 64));
  ASSERT_EQ(root.status.termination, Termination::completed) << root.status.message;
  ASSERT_EQ(root.branches.size(), 2U);
  for (const Result& branch : root.branches) {
    const auto& first = branch.events[0];
    ASSERT_EQ(first.t, 1.0);
    auto options = until(3, 1);
    options.from = 1;
    for (std::size_t j = 0; j < 2; ++j) {
      options.initial_mode.emplace_back(branch.switching_functions[j], (*first.mode_after)[j]);
    }
    auto beginning = driven(first.x_after[0], first.x_after[1]);
    const Result fresh = run(beginning, options);
    ASSERT_EQ(fresh.events.size(), branch.events.size());
    for (std::size_t i = 1; i < fresh.events.size(); ++i) {
      EXPECT_NEAR(fresh.events[i].t, branch.events[i].t, 1e-8);
      EXPECT_EQ(fresh.events[i].mode_after, branch.events[i].mode_after);
    }
    for (std::size_t i = 0; i < 2; ++i) EXPECT_NEAR(fresh.final.x[i], branch.final.x[i], 1e-8);
    EXPECT_LT(branch.statistics.steps, root.statistics.steps + fresh.statistics.steps);
    EXPECT_GT(branch.statistics.rhs_evaluations, 0);
  }
}

TEST(Branches, OfAnIntersectionAreAllModesThatLeadOn) {
  // Piecewise constant fields; case E10-010 of the decision trees: sliding along x = 0 into y = 0 goes on there, or
  // leaves into every mode whose own field points to where it says.
  Builder b("entry");
  const SX x = b.state("x", {0});
  const SX y = b.state("y", {-1});
  const SX alpha = b.step(x, "first");
  const SX beta = b.step(y, "second");
  const std::array<std::array<double, 4>, 2> f{{{0.5223, -1.7734, -0.194, 1.011}, {0.609, -0.9416, 0.3146, 0.115}}};
  const auto field = [&](const std::array<double, 4>& v) {
    return (1 - alpha) * (1 - beta) * v[0] + alpha * (1 - beta) * v[1] + (1 - alpha) * beta * v[2] +
           alpha * beta * v[3];
  };
  b.dynamics("x", field(f[0]));
  b.dynamics("y", field(f[1]));
  const Result root = run(b, until(6, 64));
  ASSERT_EQ(root.status.termination, Termination::completed) << root.status.message;
  const double slid = f[0][0] / (f[0][0] - f[0][1]);
  const double arrival = 1 / ((1 - slid) * f[1][0] + slid * f[1][1]);
  const auto& event = root.events[1];
  EXPECT_NEAR(event.t, arrival, 1e-12);
  EXPECT_EQ(*event.mode_after, (Mode{0, 0}));
  ASSERT_TRUE(event.intersection.has_value());
  EXPECT_EQ(event.intersection->surfaces, (std::array<std::string, 2>{"first", "second"}));
  EXPECT_EQ(event.intersection->velocities, f);
  ASSERT_TRUE(event.intersection->alpha_before.has_value());
  EXPECT_NEAR((*event.intersection->alpha_before)[0], slid, 1e-12);
  EXPECT_EQ((*event.intersection->alpha_before)[1], 0.0);
  EXPECT_NEAR(event.intersection->alpha_after[0], 0.5 * (1 + 0.19265383597429087), 1e-12);
  EXPECT_NEAR(event.intersection->alpha_after[1], 0.5 * (1 + 0.23490321586354418), 1e-12);

  // Where they end: along the corner fields, and along x = 0 and y = 0 between them.
  const double left = 6 - arrival;
  const double up = f[0][2] / (f[0][2] - f[0][3]);
  const double right = f[1][1] / (f[1][1] - f[1][3]);
  const std::map<Mode, std::array<double, 2>> ends{
      {{1, 1}, {left * f[0][3], left * f[1][3]}},
      {{-1, 1}, {left * f[0][2], left * f[1][2]}},
      {{0, 1}, {0, left * ((1 - up) * f[1][2] + up * f[1][3])}},
      {{1, 0}, {left * ((1 - right) * f[0][1] + right * f[0][3]), 0}},
  };
  ASSERT_EQ(root.branches.size(), ends.size());
  for (const Result& branch : root.branches) {
    const auto end = ends.find(*branch.events[0].mode_after);
    ASSERT_NE(end, ends.end());
    for (std::size_t i = 0; i < 2; ++i) EXPECT_NEAR(branch.final.x[i], end->second[i], 1e-12);
    ASSERT_TRUE(branch.events[0].intersection.has_value());
    EXPECT_EQ(branch.events[0].intersection->alpha_after[0], (*branch.events[0].alpha_after)[0]);
    EXPECT_EQ(branch.events[0].alternatives.size(), 4U);
  }
}

TEST(Branches, StopWhereTheUserStops) {
  auto b = repeated({1, 2});
  long seen = 0;
  Observers observers;
  observers.on_step = [&](const StepRecord& step) {
    EXPECT_LE(step.trajectory, step.trajectories);
    EXPECT_LE(step.trajectories, 64);
    seen = step.trajectory;
    return step.trajectory == 3 && step.t > 0.1 ? Proceed::stop : Proceed::on;
  };
  const Result root = run(b, until(2.5, 64), observers);
  EXPECT_EQ(seen, 3);
  EXPECT_EQ(root.status.termination, Termination::completed);
  ASSERT_EQ(root.branches.size(), 2U);
  EXPECT_EQ(root.branches[0].status.termination, Termination::completed);
  EXPECT_EQ(root.branches[1].status.termination, Termination::stopped_by_user);
  EXPECT_LT(root.branches[1].status.time_reached, 1.0);
}

TEST(Observers, SeeTheState) {
  Builder b("friction");
  const SX x = b.state("x", {0}), v = b.state("v", {1});
  b.dynamics("x", v);
  b.dynamics("v", -x - 0.5 * b.sign(v));
  for (const auto method : {Method::event, Method::fesd}) {
    SimulateOptions options = until(0.5, 1);
    options.method = method;
    std::vector<double> last;
    Observers observers;
    observers.on_step = [&](const StepRecord& step) {
      last.assign(step.x.begin(), step.x.end());
      return Proceed::on;
    };
    const Result root = run(b, options, observers);
    EXPECT_EQ(root.status.termination, Termination::completed);
    EXPECT_EQ(last, root.final.x);
  }
}

TEST(Branches, ThatAreNotReachedAreNoTrajectories) {
  auto b = repeated({1, 2});
  Observers observers;
  observers.on_step = [](const StepRecord& step) { return step.trajectory == 4 ? Proceed::stop : Proceed::on; };
  // The fourth leaves at t = 1 and is stopped before.
  const Result root = run(b, until(2.5, 64), observers);
  ASSERT_EQ(root.branches.size(), 2U);
  EXPECT_EQ(result::not_followed(root), 4U);
}

TEST(Branches, AreNotOfTheRegularisedSystem) {
  auto b = spontaneous();
  auto options = until(0.1, 64);
  options.method = Method::smoothed;
  EXPECT_TRUE(run(b, options).branches.empty());
}

}  // namespace
}  // namespace saltus::pipeline
