// Solutions as functions of time against the rows of the same run at the same times.
#include "saltus/result/continuous.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "problems/references.hpp"
#include "problems/simulator.hpp"

namespace saltus::problems {
namespace {

using result::Side;
using result::Trajectory;

/// Bits of every number of a row.
std::vector<std::uint64_t> bits(const Trajectory& rows, std::size_t row) {
  std::vector<std::uint64_t> all;
  const auto add = [&](const auto& table) {
    if (table.empty()) return;
    for (const auto value : table[row]) all.push_back(std::bit_cast<std::uint64_t>(static_cast<double>(value)));
  };
  add(rows.x), add(rows.u), add(rows.alpha), add(rows.mode), add(rows.outputs), add(rows.theta);
  return all;
}

/// Times at random, ends of steps, and events.
std::vector<double> times_of(const result::Result& run, int count) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> part(0.0, 1.0);
  const auto& rows = run.trajectory.t;
  std::vector<double> times;
  for (int k = 0; k < count; ++k) {
    times.push_back(rows.front() + part(random) * (rows.back() - rows.front()));
    times.push_back(rows[static_cast<std::size_t>(part(random) * static_cast<double>(rows.size() - 1))]);
  }
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end()), times.end());
  return times;
}

/// Compares values, and what the run computes with and without them; no time is to be simulated again.
void expect_rows(const Simulator& model, pipeline::SimulateOptions options) {
  options.output = pipeline::EveryStep{};
  const auto plain = model.run(options);
  options.continuous = true;
  const auto run = model.run(options);
  ASSERT_TRUE(run.continuous);
  EXPECT_EQ(run.final.x, plain.final.x);
  ASSERT_EQ(run.events.size(), plain.events.size());
  for (std::size_t k = 0; k < run.events.size(); ++k) EXPECT_EQ(run.events[k].t, plain.events[k].t);
  const auto times = times_of(run, 40);
  options.continuous = false;
  options.output = pipeline::AtTimes{times};
  options.event_rows = true;
  const auto asked = model.run(options);
  const auto rows_at = [](const result::Result& of, double t) {
    return std::count(of.trajectory.t.begin(), of.trajectory.t.end(), t);
  };
  long simulated = 0;
  const auto count = [&](const result::Progress&) {
    ++simulated;
    return result::Continue::yes;
  };
  for (const Side side : {Side::before, Side::behind}) {
    const auto values = run.continuous->at(times, side, count);
    ASSERT_TRUE(values) << to_text(values.error());
    ASSERT_EQ(values->t, times);
    for (std::size_t k = 0; k < times.size(); ++k) {
      // Where inputs and outputs break rows at times are those behind, and steps have both.
      if (side == Side::before && rows_at(run, times[k]) > rows_at(asked, times[k])) continue;
      Trajectory row;
      ASSERT_TRUE(result::append_row_at(times[k], side, asked.trajectory, row));
      EXPECT_EQ(bits(*values, k), bits(row, 0)) << "t = " << times[k];
    }
  }
  EXPECT_EQ(simulated, 0);
}

class ContinuousSolution : public testing::TestWithParam<ReferenceProblem> {};

TEST_P(ContinuousSolution, HasTheBitsOfRows) {
  const Simulator model = Simulator::from_reference(GetParam());
  const bool stiff = GetParam().model == "smoothed-pss";  // no model for an explicit method
  const Accuracy high{pipeline::Integrator::dop853, 1e-8, 1e-10}, series{pipeline::Integrator::taylor, 1e-8, 1e-10};
  for (const Accuracy& accuracy : stiff ? std::vector{implicit} : std::vector{standard, high, implicit, series}) {
    SCOPED_TRACE(static_cast<int>(accuracy.integrator));
    expect_rows(model, with(model.options(), accuracy));
  }
}

INSTANTIATE_TEST_SUITE_P(Models, ContinuousSolution, testing::ValuesIn(references()),
                         [](const auto& instance) { return test_name(instance.param); });

TEST(ContinuousSolutionOfElements, HasTheBitsOfRows) {
  for (const std::string name : {"stick-slip", "relay-feedback", "two-belts", "repressilator", "irma", "chua",
                                 "bridge-rectifier", "gear-backlash"}) {
    SCOPED_TRACE(name);
    const Simulator model = Simulator::from_catalogue(name);
    auto options = model.options();
    for (const auto method : {pipeline::Method::fesd, pipeline::Method::timestepping}) {
      options.method = method;
      expect_rows(model, options);
    }
  }
}

TEST(ContinuousSolutionOfLayers, HasTheBitsOfRows) {
  for (const std::string name : {"stick-slip", "sliding", "crossing"}) {
    SCOPED_TRACE(name);
    const Simulator model = Simulator::from_catalogue(name);
    auto options = model.options();
    options.method = pipeline::Method::smoothed;
    expect_rows(model, options);
  }
}

/// Every branch against its rows: those of its own choices.
void expect_rows_of_branches(const result::Result& run, const result::Result& rows) {
  ASSERT_TRUE(run.continuous);
  ASSERT_EQ(run.branches.size(), rows.branches.size());
  std::vector<double> times;
  for (const double t : rows.trajectory.t) {
    if (rows.trajectory.t.front() < t && (times.empty() || times.back() < t)) times.push_back(t);
  }
  for (const Side side : {Side::before, Side::behind}) {
    const auto values = run.continuous->at(times, side);
    ASSERT_TRUE(values) << to_text(values.error());
    for (std::size_t k = 0; k < times.size(); ++k) {
      Trajectory row;
      ASSERT_TRUE(result::append_row_at(times[k], side, rows.trajectory, row));
      EXPECT_EQ(bits(*values, k), bits(row, 0)) << "t = " << times[k];
    }
  }
  for (std::size_t b = 0; b < run.branches.size(); ++b) expect_rows_of_branches(run.branches[b], rows.branches[b]);
}

TEST(ContinuousSolutionOfBranches, FollowsTheChoicesOfEach) {
  for (const std::string name : {"spontaneous-switch", "stay-or-leave", "stay-or-slide", "slide-or-leave"}) {
    SCOPED_TRACE(name);
    const Simulator model = Simulator::from_catalogue(name);
    auto options = model.options();
    options.event.trajectories = 8;
    options.event.members = 2;
    options.output = pipeline::NumberOfPoints{37};
    const auto rows = model.run(options);
    EXPECT_FALSE(rows.branches.empty());
    options.output = pipeline::EveryStep{};
    options.continuous = true;
    expect_rows_of_branches(model.run(options), rows);
  }
}

/// x'' = -x, and 100 switches of something that it drives.
const char* const through_switches =
    "[model]\nname = \"waves\"\n[states]\nx = 1\nv = 0\nw = 0\ns = 0.5\n[dynamics]\nx = \"v\"\nv = \"-x\"\nw = "
    "\"x*sign(s - 0.05)\"\ns = \"0.5*v\"\n[simulate]\nuntil = 320\nrtol = 1e-3\natol = 1e-3\n";

TEST(ContinuousSolution, ConvergesWithTheOrderOfTheDenseOutputThroughEvents) {
  const Simulator model = Simulator::from_text(through_switches);
  std::vector<double> times;
  for (int k = 1; k <= 500; ++k) times.push_back(0.637 * k);
  const auto error = [&](pipeline::Integrator integrator, double step) {
    auto options = model.options();
    options.continuous = true;
    options.event.integrator = integrator;
    options.event.max_step = step;
    const auto run = model.run(options);
    EXPECT_GE(run.events.size(), 100U);
    const auto values = run.continuous->at(times);
    EXPECT_TRUE(values);
    double largest = 0.0;
    for (std::size_t k = 0; k < times.size(); ++k) {
      largest = std::max(largest, std::abs(values->x[k][0] - std::cos(times[k])));
    }
    return largest;
  };
  struct Expected {
    pipeline::Integrator integrator;
    double step;
    double order;  ///< less a half
  };
  for (const auto& [integrator, step, order] : {Expected{pipeline::Integrator::dopri5, 0.2, 3.5},
                                                {pipeline::Integrator::dop853, 0.8, 6.5},
                                                {pipeline::Integrator::radau5, 0.2, 3.5}}) {
    EXPECT_GT(std::log2(error(integrator, step) / error(integrator, step / 2.0)), order)
        << static_cast<int>(integrator);
  }
}

TEST(ContinuousSolution, HasBothSidesOfEventsWhateverRowsThereAre) {
  const Simulator model = Simulator::from_catalogue("bouncing-ball");
  auto options = model.options();
  options.continuous = true;
  options.event_rows = false;
  options.output = pipeline::NumberOfPoints{2};
  options.kept.states = {{"y"}};
  const auto run = model.run(options);
  const auto event = run.events.front();
  EXPECT_EQ(run.continuous->at({event.t}, Side::before)->x[0], event.x);
  EXPECT_EQ(run.continuous->at({event.t}, Side::behind)->x[0], event.x_after);
}

TEST(ContinuousSolution, IsKnownWithinTheSpanOnly) {
  const Simulator model = Simulator::from_catalogue("stick-slip");
  auto options = model.options();
  options.continuous = true;
  options.until = 2.0;
  const auto run = model.run(options);
  for (const double t : {-1e-9, 2.1, std::numeric_limits<double>::quiet_NaN()}) {
    const auto values = run.continuous->at({1.0, t});
    ASSERT_FALSE(values);
    EXPECT_NE(values.error().message.find("lies outside the solution, which is known from 0 to 2"), std::string::npos);
  }
}

TEST(ContinuousSolution, EndsWhereRoundingsOfItsEndAre) {
  const Simulator model = Simulator::from_catalogue("stick-slip");
  auto options = model.options();
  options.continuous = true;
  options.until = 2.0;
  const auto run = model.run(options);
  const auto values = run.continuous->at({2.0, std::nextafter(2.0, 3.0)});
  ASSERT_TRUE(values);
  EXPECT_EQ(values->t, (std::vector<double>{2.0, 2.0}));
  EXPECT_EQ(values->x[1], values->x[0]);
}

// Along a way into a zero of a nested function, and over a limit, the solution is no polynomial of a step.
TEST(ContinuousSolution, IsSimulatedAgainWhereStepsHaveNoPolynomials) {
  const Simulator model = Simulator::from_text(
      "[model]\nname = \"ball\"\n[states]\ny = 1\nv = 0\n[dynamics]\ny = \"v\"\nv = \"-9.81\"\n[[jumps]]\nname = "
      "\"bounce\"\nwhen = \"y\"\ndirection = \"down\"\nset = { v = \"-0.8*v\" }\n[simulate]\nuntil = 5\n");
  auto options = model.options();
  options.continuous = true;
  const auto run = model.run(options);
  double limit = 0.0, last = 0.0;
  for (std::size_t k = 0; k < run.events.size(); ++k) {
    if (run.events[k].kind == result::EventKind::accumulation) limit = run.events.t(k);
    if (limit == 0.0) last = run.events.t(k);
  }
  ASSERT_LT(last, limit);
  const double t = 0.5 * (last + limit);
  long simulated = 0;
  const auto values = run.continuous->at({t}, Side::behind, [&](const result::Progress&) {
    ++simulated;
    return result::Continue::yes;
  });
  ASSERT_TRUE(values) << to_text(values.error());
  EXPECT_GT(simulated, 0);
  options.output = pipeline::AtTimes{{t}};
  Trajectory row;
  ASSERT_TRUE(result::append_row_at(t, Side::behind, model.run(options).trajectory, row));
  EXPECT_EQ(bits(*values, 0), bits(row, 0));
}

}  // namespace
}  // namespace saltus::problems
