// The regularised system converges to the event-driven solution with order 1 in epsilon: two methods that share no
// decision have one limit.
//
// The layer delays or advances every switch by a time of order epsilon / |psi'|, and a sliding solution runs in it at a
// distance of order epsilon from the surface, so errors are C epsilon once epsilon is small. The slope is a
// least-squares fit of log(error) over log(epsilon).
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ostream>
#include <string>
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

struct Measurement {
  double epsilon = 0.0;
  double error = 0.0;
};

double slope_of(const std::vector<Measurement>& points) {
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
  long most_steps;  ///< of the smallest epsilon, accepted and rejected: measured, times 1.5
};
void PrintTo(const SmoothedCase& c, std::ostream* out) { *out << c.model; }

class Smoothed : public testing::TestWithParam<SmoothedCase> {};

TEST_P(Smoothed, ConvergesToTheEventEngineWithOrderOne) {
  const ReferenceProblem& problem = reference(GetParam().model);
  const Simulator model = Simulator::from_reference(problem);
  std::vector<Measurement> points;
  std::string table;
  for (const double epsilon : {1e-3, 3e-4, 1e-4, 3e-5, 1e-5, 3e-6, 1e-6}) {
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
    EXPECT_LT(distance(result.final.alpha, problem.final_alpha), 30 * epsilon + 1e-5) << epsilon;
    if (epsilon == 1e-6) {
      EXPECT_LE(steps, GetParam().most_steps);
    }
  }
  const double slope = slope_of(points);
  RecordProperty("slope", std::to_string(slope));
  EXPECT_GT(slope, 0.9) << table;
  EXPECT_LT(slope, 1.1) << table;
  EXPECT_LT(points.back().error, 1e-4) << table;
  if (std::getenv("SALTUS_SHOW") != nullptr)
    std::printf("%s slope %g\n%s", GetParam().model.c_str(), slope, table.c_str());
}

INSTANTIATE_TEST_SUITE_P(Models, Smoothed,
                         testing::Values(SmoothedCase{"crossing", 1000}, SmoothedCase{"asymmetric-sliding", 1000},
                                         SmoothedCase{"leaving-sliding", 1000},
                                         SmoothedCase{"rotating-oscillator", 1000}, SmoothedCase{"two-lines", 1000},
                                         SmoothedCase{"stick-slip", 1000}, SmoothedCase{"relay-oscillator", 10000},
                                         SmoothedCase{"relay-feedback", 10000}, SmoothedCase{"circle", 1000},
                                         SmoothedCase{"sweeping-disc", 1000}, SmoothedCase{"friction-blocks", 10000},
                                         SmoothedCase{"quadrants", 10000}, SmoothedCase{"irma", 10000}),
                         [](const auto& instance) {
                           std::string name = instance.param.model;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

}  // namespace
}  // namespace saltus::problems
