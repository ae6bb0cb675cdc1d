// Straight lines between the rows of output = "auto" against the rows of the same run at many points.
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "problems/references.hpp"
#include "problems/simulator.hpp"

namespace saltus::problems {
namespace {

using result::Trajectory;
using Column = std::function<double(const Trajectory&, std::size_t row)>;

struct Named {
  std::string name;
  Column at;
};

std::vector<Named> columns_of(const result::Result& result) {
  std::vector<Named> columns;
  const auto add = [&](const std::vector<std::string>& names, auto member) {
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (names[i].starts_with("impulse(")) continue;  // is there at one instant only
      columns.push_back(
          {names[i], [member, i](const Trajectory& rows, std::size_t row) { return (rows.*member)[row][i]; }});
    }
  };
  add(result.states, &Trajectory::x);
  add(result.controls, &Trajectory::u);
  add(result.outputs, &Trajectory::outputs);
  add(result.switching_functions, &Trajectory::alpha);
  return columns;
}

/// Distance of a value at t from the lines there: at an event from the nearer one.
double distance(const Trajectory& rows, const Column& column, double t, double value) {
  const auto begin = std::lower_bound(rows.t.begin(), rows.t.end(), t) - rows.t.begin();
  double nearest = std::numeric_limits<double>::infinity();
  const auto look = [&](double other) { nearest = std::min(nearest, std::abs(other - value)); };
  auto row = static_cast<std::size_t>(begin);
  if (row > 0 && row < rows.t.size() && rows.t[row] > t) {
    const double part = (t - rows.t[row - 1]) / (rows.t[row] - rows.t[row - 1]);
    const double left = column(rows, row - 1), right = column(rows, row);
    look(left + part * (right - left));
    if (std::isnan(left) || std::isnan(right)) return 0.0;  // what nothing determines is not drawn
  }
  for (; row < rows.t.size() && rows.t[row] == t; ++row) look(column(rows, row));
  return nearest;
}

void expect_true_lines(const result::Result& drawn, const result::Result& points,
                       const pipeline::SimulateOptions& options) {
  ASSERT_EQ(drawn.final.t, points.final.t);
  ASSERT_EQ(drawn.final.x, points.final.x);
  for (const auto& [name, at] : columns_of(drawn)) {
    double low = std::numeric_limits<double>::infinity(), high = -low, worst = 0.0, when = 0.0;
    for (std::size_t row = 0; row < points.trajectory.t.size(); ++row) {
      const double value = at(points.trajectory, row);
      if (std::isnan(value)) continue;
      low = std::min(low, value);
      high = std::max(high, value);
      const double d = distance(drawn.trajectory, at, points.trajectory.t[row], value);
      if (d > worst) when = points.trajectory.t[row];
      worst = std::max(worst, d);
    }
    if (!(low <= high)) continue;
    // What is less than the tolerance of the run is no shape.
    const double floor = 10.0 * (options.atol + options.rtol * std::max(std::abs(low), std::abs(high)));
    EXPECT_LE(worst, 2e-3 * (high - low) + floor) << name << " at t = " << when << ", range " << high - low;
  }
}

void check(const Simulator& model, pipeline::SimulateOptions options) {
  options.output = pipeline::NumberOfPoints{1501};
  const auto points = model.run(options);
  options.output = pipeline::Automatic{};
  expect_true_lines(model.run(options), points, options);
}

class Lines : public testing::TestWithParam<ReferenceProblem> {};

TEST_P(Lines, AreWithinTwoThousandthsOfEveryRange) {
  const Simulator model = Simulator::from_reference(GetParam());
  const bool stiff = GetParam().model == "smoothed-pss";  // no model for an explicit method
  const Accuracy loose{pipeline::Integrator::dop853, 1e-6, 1e-8},
      loose_series{pipeline::Integrator::taylor, 1e-6, 1e-8};
  for (const Accuracy& accuracy :
       stiff ? std::vector{implicit} : std::vector{standard, implicit, loose, loose_series}) {
    SCOPED_TRACE(static_cast<int>(accuracy.integrator));
    check(model, with(model.options(), accuracy));
  }
}

INSTANTIATE_TEST_SUITE_P(Models, Lines, testing::ValuesIn(references()),
                         [](const auto& instance) { return test_name(instance.param); });

TEST(LinesOfElements, AreTrue) {
  for (const std::string name : {"stick-slip", "relay-feedback", "two-belts", "repressilator", "irma"}) {
    SCOPED_TRACE(name);
    const Simulator model = Simulator::from_catalogue(name);
    auto options = model.options();
    options.method = pipeline::Method::fesd;
    check(model, options);
  }
}

TEST(LinesOfLayers, AreTrue) {
  for (const std::string name : {"stick-slip", "sliding", "crossing"}) {
    SCOPED_TRACE(name);
    const Simulator model = Simulator::from_catalogue(name);
    auto options = model.options();
    options.method = pipeline::Method::smoothed;
    check(model, options);
  }
}

// A parabola of height h is 2 sqrt(h / (8 tolerance)) lines; steps and flights that begin add some.
TEST(LinesOfABall, AreParabolasAndNotManyMore) {
  const Simulator model = Simulator::from_text(
      "[model]\nname = \"ball\"\n[states]\ny = 1\nv = 0\n[dynamics]\ny = \"v\"\nv = \"-9.81\"\n[[jumps]]\nname = "
      "\"bounce\"\nwhen = \"y\"\ndirection = \"down\"\nset = { v = \"-0.8*v\" }\n[simulate]\nuntil = 3\n");
  const auto ball = model.run(model.options());
  const auto& rows = ball.trajectory;
  double rebound = 0.0;
  for (std::size_t row = 0; row < rows.t.size(); ++row) {
    if (rows.t[row] > ball.events[0].t) rebound = std::max(rebound, rows.x[row][0]);
  }
  EXPECT_NEAR(rebound, 0.64, 1e-3);
  EXPECT_LT(rows.t.size(), 400U);
  check(model, model.options());
}

}  // namespace
}  // namespace saltus::problems
