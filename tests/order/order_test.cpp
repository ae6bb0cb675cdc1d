// Errors fall with the order of the integrator through crossings, sliding on lines and on curves, and exits.
//
// The error control is switched off by tolerances that accept every step; max_step then sets the step length h. The
// steps that end at an event are shorter, so the errors scatter around C h^p: the slope is a least-squares fit of
// log(error) over log(h). Points near rounding are left out.
#include <algorithm>
#include <cmath>
#include <ostream>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "problems/references.hpp"
#include "problems/simulator.hpp"

namespace saltus::problems {
namespace {

using pipeline::Integrator;

struct Measurement {
  double h = 0.0;
  double error = 0.0;
};

struct OrderCase {
  std::string model;
  Integrator integrator;
  double order;
  double coarsest;  ///< largest step: small enough that the leading term of the error dominates
  double ratio;     ///< of successive steps
};

std::string test_name(const OrderCase& c) {
  constexpr const char* endings[] = {"_dopri5", "_dop853", "_radau5"};
  std::string text = c.model + endings[static_cast<std::size_t>(c.integrator)];
  std::replace(text.begin(), text.end(), '-', '_');
  return text;
}

void PrintTo(const OrderCase& c, std::ostream* out) { *out << test_name(c); }

constexpr double accept_everything = 1e6;

double error_of(const Simulator& model, const ReferenceProblem& problem, Integrator integrator, double h) {
  pipeline::SimulateOptions options = with(model.options(), {integrator, accept_everything, accept_everything});
  options.event.max_step = h;
  options.output = pipeline::EveryStep{};
  const result::Result result = model.run(options);
  if (result.status.termination != result::Termination::completed) throw std::runtime_error(result.status.message);
  EXPECT_EQ(result.events.size(), problem.events.size()) << "h = " << h;
  EXPECT_GE(static_cast<double>(result.statistics.steps) * h, 0.99 * problem.until) << "steps longer than max_step";
  double error = 0.0;
  for (std::size_t i = 0; i < problem.final_x.size(); ++i) {
    error = std::max(error, std::abs(result.final.x[i] - problem.final_x[i]));
  }
  for (std::size_t i = 0; i < std::min(result.events.size(), problem.events.size()); ++i) {
    error = std::max(error, std::abs(result.events[i].t - problem.events[i].t));
  }
  return error;
}

double fitted_slope(const std::vector<Measurement>& points) {
  double mean_x = 0.0, mean_y = 0.0;
  for (const Measurement& p : points) {
    mean_x += std::log(p.h) / static_cast<double>(points.size());
    mean_y += std::log(p.error) / static_cast<double>(points.size());
  }
  double covariance = 0.0, variance = 0.0;
  for (const Measurement& p : points) {
    covariance += (std::log(p.h) - mean_x) * (std::log(p.error) - mean_y);
    variance += (std::log(p.h) - mean_x) * (std::log(p.h) - mean_x);
  }
  return covariance / variance;
}

std::string table(const std::vector<Measurement>& points) {
  std::string text;
  for (const Measurement& p : points) {
    text += "h = " + std::to_string(p.h) + ", log10(error) = " + std::to_string(std::log10(p.error)) + "\n";
  }
  return text;
}

class Order : public testing::TestWithParam<OrderCase> {};

TEST_P(Order, SlopeIsNominal) {
  const OrderCase& c = GetParam();
  const ReferenceProblem& problem = reference(c.model);
  const Simulator model = Simulator::from_reference(problem);
  // accumulated over some hundred steps, times up to 50
  constexpr double rounding = 3e-13;
  constexpr int levels = 40;  // many, because the steps that end at events scatter
  std::vector<Measurement> points;
  double h = c.coarsest;
  for (int level = 0; level < levels; ++level, h /= c.ratio) {
    const double error = error_of(model, problem, c.integrator, h);
    if (error > rounding) points.push_back({h, error});
  }
  ASSERT_GE(points.size(), 20u) << table(points);
  const double slope = fitted_slope(points);
  RecordProperty("slope", std::to_string(slope));
  // An order lost at the events would give order - 1; the scatter of the fits is about 0.2.
  EXPECT_GT(slope, c.order - 0.4) << table(points);
  EXPECT_LT(points.back().error, points.front().error);
}

INSTANTIATE_TEST_SUITE_P(
    Integrators, Order,
    testing::Values(OrderCase{"rotating-oscillator", Integrator::dopri5, 5, 0.015, 1.06},
                    OrderCase{"rotating-oscillator", Integrator::dop853, 8, 0.08, 1.04},
                    OrderCase{"rotating-oscillator", Integrator::radau5, 5, 0.015, 1.06},
                    OrderCase{"relay-oscillator", Integrator::dopri5, 5, 0.4, 1.06},
                    OrderCase{"relay-oscillator", Integrator::dop853, 8, 0.6, 1.04},
                    OrderCase{"relay-oscillator", Integrator::radau5, 5, 0.4, 1.06},
                    OrderCase{"dry-friction-oscillator", Integrator::dopri5, 5, 0.4, 1.06},
                    OrderCase{"dry-friction-oscillator", Integrator::dop853, 8, 1.0, 1.04},
                    OrderCase{"dry-friction-oscillator", Integrator::radau5, 5, 0.4, 1.06},
                    OrderCase{"stick-slip", Integrator::dopri5, 5, 0.2, 1.06},
                    // On this field, without any event, the slope of DOP853 rises from 6.6 to 7.8 between h = 0.23 and
                    // h = 0.06, and then rounding takes over: order 8 is out of reach in double precision.
                    OrderCase{"stick-slip", Integrator::dop853, 7.4, 0.24, 1.03},
                    OrderCase{"stick-slip", Integrator::radau5, 5, 0.2, 1.06},
                    OrderCase{"friction-blocks", Integrator::dopri5, 5, 0.3, 1.06},
                    OrderCase{"friction-blocks", Integrator::dop853, 8, 0.6, 1.04},
                    OrderCase{"friction-blocks", Integrator::radau5, 5, 0.3, 1.06},
                    OrderCase{"circle", Integrator::dopri5, 5, 0.2, 1.06},
                    OrderCase{"circle", Integrator::dop853, 8, 0.4, 1.04},
                    OrderCase{"circle", Integrator::radau5, 5, 0.2, 1.06},
                    OrderCase{"sweeping-disc", Integrator::dopri5, 5, 0.3, 1.06},
                    OrderCase{"sweeping-disc", Integrator::dop853, 8, 0.5, 1.04},
                    OrderCase{"sweeping-disc", Integrator::radau5, 5, 0.3, 1.06},
                    // Regions by indicator: through borders of two, onto and off points where three meet.
                    OrderCase{"empty-circle", Integrator::dopri5, 5, 0.4, 1.06},
                    // The first event, before which nothing switches, has the slopes 7.4 and 4.6 itself here.
                    OrderCase{"empty-circle", Integrator::dop853, 7.4, 0.5, 1.03},
                    OrderCase{"empty-circle", Integrator::radau5, 4.9, 0.4, 1.06},
                    OrderCase{"three-windings", Integrator::dopri5, 5, 0.4, 1.06},
                    OrderCase{"three-windings", Integrator::dop853, 8, 0.6, 1.04},
                    OrderCase{"three-windings", Integrator::radau5, 5, 0.4, 1.06},
                    // Jumps of the field's parameters and of the state itself.
                    OrderCase{"hiskens-pai", Integrator::dopri5, 5, 0.01, 1.06},
                    OrderCase{"hiskens-pai", Integrator::radau5, 5, 0.01, 1.06},
                    OrderCase{"simple-jump", Integrator::dopri5, 5, 0.4, 1.06},
                    OrderCase{"simple-jump", Integrator::dop853, 8, 0.27, 1.02},
                    OrderCase{"simple-jump", Integrator::radau5, 5, 0.4, 1.06}),
    [](const auto& instance) { return test_name(instance.param); });

}  // namespace
}  // namespace saltus::problems
