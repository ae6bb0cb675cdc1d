// The regularised system converges to the event-driven solution with order 1 in epsilon: two methods that share no
// decision have one limit.
//
// The layer delays or advances every switch by a time of order epsilon / |psi'|, and a sliding solution runs in it at a
// distance of order epsilon from the surface, so errors are C epsilon once epsilon is small. Where the two sides
// cancel, because the speed through the layer is the same on both, the order is 2. The slope is a least-squares fit of
// log(error) over log(epsilon).
#include <algorithm>
#include <cmath>
#include <ostream>
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "problems/references.hpp"
#include "problems/simulator.hpp"

namespace saltus::problems {
namespace {

using pipeline::SimulateOptions;
using result::Result;

SimulateOptions smoothed(SimulateOptions options, double epsilon) {
  options.method = pipeline::Method::smoothed;
  options.smoothed.epsilon = epsilon;
  options.rtol = 1e-9;
  options.atol = 1e-3 * std::min(epsilon, 1e-6);  // of the layer's width
  options.output = pipeline::NumberOfPoints{11};
  return options;
}

double distance(const std::vector<double>& a, const std::vector<double>& b) {
  double largest = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
  return largest;
}

struct LayerMeasurement {
  double epsilon = 0.0;
  double error = 0.0;
};

double slope_of(const std::vector<LayerMeasurement>& points) {
  double mean_x = 0.0, mean_y = 0.0, covariance = 0.0, variance = 0.0;
  for (const auto& p : points) {
    mean_x += std::log(p.epsilon) / static_cast<double>(points.size());
    mean_y += std::log(p.error) / static_cast<double>(points.size());
  }
  for (const auto& p : points) {
    covariance += (std::log(p.epsilon) - mean_x) * (std::log(p.error) - mean_y);
    variance += (std::log(p.epsilon) - mean_x) * (std::log(p.epsilon) - mean_x);
  }
  return covariance / variance;
}

struct SmoothedCase {
  std::string model;
  double order;
  double coarsest;  ///< epsilon: the leading term of the error dominates from here to
  double finest;    ///< where the tolerances still see the layer
  long most_steps;  ///< with the smallest epsilon, accepted and rejected: as measured, and a half more
};
void PrintTo(const SmoothedCase& c, std::ostream* out) { *out << c.model; }

class Smoothed : public testing::TestWithParam<SmoothedCase> {};

TEST_P(Smoothed, ConvergesToTheEventEngineWithOrderOne) {
  const ReferenceProblem& problem = reference(GetParam().model);
  const Simulator model = Simulator::from_reference(problem);
  std::vector<LayerMeasurement> points;
  std::string table;
  constexpr int levels = 7;
  for (int level = 0; level < levels; ++level) {
    const double epsilon = GetParam().coarsest * std::pow(GetParam().finest / GetParam().coarsest, level / 6.0);
    const Result result = model.run(smoothed(model.options(), epsilon));
    ASSERT_EQ(result.status.termination, result::Termination::completed) << result.status.message;
    EXPECT_EQ(result.method, "smoothed");
    EXPECT_EQ(result.final.t, problem.until);
    EXPECT_EQ(result.final.mode, problem.final_mode) << "epsilon = " << epsilon;
    points.push_back({epsilon, distance(result.final.x, problem.final_x)});
    const long steps = result.statistics.steps + result.statistics.rejected;
    table += "epsilon " + std::to_string(std::log10(epsilon)) + ", log10(error) " +
             std::to_string(std::log10(points.back().error)) + ", steps " + std::to_string(steps) + ", alpha off by " +
             std::to_string(distance(result.final.alpha, problem.final_alpha)) + "\n";
    // The selection of a sliding mode is the one that the event engine computes, to order epsilon.
    EXPECT_LT(distance(result.final.alpha, problem.final_alpha), 300 * epsilon) << epsilon;
    if (level == levels - 1) {
      EXPECT_LE(steps, GetParam().most_steps);
    }
  }
  const double slope = slope_of(points);
  RecordProperty("slope", std::to_string(slope));
  EXPECT_NEAR(slope, GetParam().order, 0.1) << table;
}

/// Four quadrants by indicators, which depend on each other at their corner; z hangs on the weights there. Into the
/// edge y = 0, into the corner, and in a wind out along the edge x > 0.
Simulator quadrants() {
  return Simulator::from_text(R"toml(
[model]
name = "quadrants by indicator"
[definitions]
wind = "max(t - 3, 0)"
[states]
x = 1
y = 0.7
z = 0
[dynamics]
x = "wind"
[[modes]]
name = "pp"
indicator = "-x - y"
dynamics = { x = "-1", y = "-2", z = "1" }
[[modes]]
name = "mp"
indicator = "x - y"
dynamics = { x = "1.5", y = "-1", z = "0" }
[[modes]]
name = "pm"
indicator = "-x + y"
dynamics = { x = "-1", y = "1", z = "-1" }
[[modes]]
name = "mm"
indicator = "x + y"
dynamics = { x = "1", y = "1", z = "3" }
[simulate]
until = 6
)toml");
}

// Soft minima have no layer that ends: where a region is left tangentially, at t = 4 here, the weights that it keeps
// for a while move the solution by epsilon log(1 / epsilon), whose slope over these epsilons is 1 - 1 / log(1 /
// epsilon), 0.86 to 0.93. While the corner is held the error is of order 1.
TEST(SmoothedRegions, ConvergeWhereIndicatorsDependOnEachOther) {
  const Simulator model = quadrants();
  for (const auto& [until, low, high] : {std::tuple{3.0, 0.95, 1.05}, {6.0, 0.85, 1.05}}) {
    SimulateOptions options = model.options();
    options.until = until;
    options.rtol = 1e-11;
    options.atol = 1e-13;
    const Result event = model.run(options);
    ASSERT_EQ(event.status.termination, result::Termination::completed) << event.status.message;
    std::vector<LayerMeasurement> points;
    for (const double epsilon : {1e-3, 3e-4, 1e-4, 3e-5, 1e-5, 1e-6}) {
      const Result result = model.run(smoothed(options, epsilon));
      ASSERT_EQ(result.status.termination, result::Termination::completed) << result.status.message;
      EXPECT_EQ(result.final.regions, event.final.regions) << epsilon;
      EXPECT_LT(distance(result.final.theta, event.final.theta), 10 * epsilon) << epsilon;
      points.push_back({epsilon, distance(result.final.x, event.final.x)});
    }
    EXPECT_GT(slope_of(points), low) << "until " << until;
    EXPECT_LT(slope_of(points), high) << "until " << until;
  }
}

/// 330 to 370 epsilon are the layer's; rtol acts where the solution is outside: the event engine itself ends within
/// rtol / 10 of its end at tight tolerances.
void expect_error_of_the_layer(const std::vector<double>& epsilons, const std::vector<double>& rtols) {
  const ReferenceProblem& problem = reference("relay-feedback");
  const Simulator model = Simulator::from_reference(problem);
  for (const double epsilon : epsilons) {
    for (const double rtol : rtols) {
      SimulateOptions options = smoothed(model.options(), epsilon);
      options.rtol = rtol;
      options.atol = rtol / 100;
      const Result result = model.run(options);
      ASSERT_EQ(result.status.termination, result::Termination::completed) << result.status.message;
      EXPECT_LT(distance(result.final.x, problem.final_x), 400 * epsilon + 10 * rtol)
          << "epsilon = " << epsilon << ", rtol = " << rtol;
    }
  }
}

// Tolerances that do not see the layer are lowered in it. Without that the relay ended at errors from 0.06 to 1000
// for epsilon below 30 to 1000 times atol, and nothing said so.
TEST(SmoothedTolerances, LooseOnesLeaveTheErrorOfTheLayer) {
  expect_error_of_the_layer({1e-5, 1e-6, 1e-7, 1e-8}, {1e-5, 1e-6, 1e-7, 1e-8});
}

// Still looser ones: what errors of all states do to the speed at which a solution leaves a layer tangentially. rtol of
// more than 1000 epsilon made of the relay's exits other ones, and the run completed with errors from 5 to 600.
TEST(SmoothedTolerances, LooserOnesThanTheLayerIsThinLeaveTangentiallyWhereTheyShould) {
  expect_error_of_the_layer({1e-7, 1e-8, 1e-9}, {1e-2, 1e-3, 1e-4, 1e-5});
}

// A surface away from 0, so that it is rtol that does not see the layer. x slides on 3 with x' = 0, y' = alpha.
TEST(SmoothedTolerances, SurfacesAwayFromZeroAreSeen) {
  const Simulator model = Simulator::from_text(R"toml(
[model]
name = "away"
[states]
x = 3.5
y = 0
[dynamics]
x = "cos(5*t) - 2*sign(x - 3)"
y = "step(x - 3)"
[simulate]
until = 10
)toml");
  for (const double epsilon : {1e-5, 1e-6, 1e-7}) {
    for (const double rtol : {1e-4, 1e-6, 1e-8}) {
      SimulateOptions options = smoothed(model.options(), epsilon);
      options.rtol = rtol;
      options.atol = rtol / 100;
      const Result result = model.run(options);
      ASSERT_EQ(result.status.termination, result::Termination::completed) << result.status.message;
      const double alpha = 0.5 + std::cos(50.0) / 4;
      EXPECT_NEAR(result.final.alpha[0], alpha, 5 * epsilon + 1e-3) << "epsilon = " << epsilon << ", rtol = " << rtol;
      EXPECT_NEAR(result.final.x[0], 3 + epsilon * (2 * alpha - 1), 1e-3 * epsilon) << epsilon;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    Models, Smoothed,
    testing::Values(
        SmoothedCase{"crossing", 1, 1e-3, 1e-6, 40}, SmoothedCase{"asymmetric-sliding", 1, 1e-3, 1e-6, 60},
        SmoothedCase{"leaving-sliding", 1, 1e-3, 1e-6, 10}, SmoothedCase{"two-lines", 1, 1e-3, 1e-6, 50},
        SmoothedCase{"stick-slip", 1, 1e-3, 1e-6, 2400}, SmoothedCase{"relay-oscillator", 1, 1e-3, 1e-6, 10000},
        // After a tangential exit x1 dips back by less than tolerances see in a still thinner layer.
        SmoothedCase{"relay-feedback", 1, 1e-5, 1e-7, 8000}, SmoothedCase{"friction-blocks", 1, 1e-3, 1e-6, 1000},
        SmoothedCase{"quadrants", 1, 1e-3, 1e-6, 1700}, SmoothedCase{"irma", 2, 1e-4, 1e-7, 5000},
        SmoothedCase{"rotating-oscillator", 2, 1e-2, 1e-5, 1200},
        // On a curved surface the stiff direction turns, and the simplified Newton iteration with it: steps
        // are of the order of sqrt(epsilon).
        // Regions by indicator, left tangentially but for frozen-hysteresis: epsilon log(1 / epsilon).
        SmoothedCase{"empty-circle", 1, 1e-3, 1e-6, 600}, SmoothedCase{"three-windings", 1, 1e-3, 1e-6, 7200},
        SmoothedCase{"frozen-hysteresis", 1, 1e-3, 1e-6, 950}, SmoothedCase{"circle", 1, 1e-3, 1e-6, 3200},
        SmoothedCase{"sweeping-disc", 1, 1e-3, 1e-6, 8500}),
    [](const auto& instance) {
      std::string name = instance.param.model;
      std::replace(name.begin(), name.end(), '-', '_');
      return name;
    });

}  // namespace
}  // namespace saltus::problems
