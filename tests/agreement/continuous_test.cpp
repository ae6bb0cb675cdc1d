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

/// How many of the times there were no polynomials for is what `unknown` is for.
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
  for (const std::string name : {"stick-slip", "relay-feedback", "two-belts", "repressilator", "irma"}) {
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

}  // namespace
}  // namespace saltus::problems
