#include "saltus/pipeline/order.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace saltus::pipeline {
namespace {

using result::OrderSeries;
using result::Result;

Result finished(std::vector<double> x, std::vector<double> switches) {
  Result r;
  r.trajectory.t = {0.0, 2.0};
  r.final.t = 2.0;
  r.final.x = std::move(x);
  for (const double t : switches) {
    result::Event event;
    event.t = t;
    r.events.push_back(event);
  }
  return r;
}

TEST(Order, SchemesAreRead) {
  const auto schemes = parse_schemes("radau_iia:2,gauss_legendre:3");
  ASSERT_TRUE(schemes);
  EXPECT_EQ(*schemes, (std::vector<OrderScheme>{{"radau_iia", 2}, {"gauss_legendre", 3}}));
  for (const auto* wrong : {"", "radau_iia", "radau_iia:", ":2", "radau_iia:0", "radau_iia:2.5", "radau_iia:2,",
                            "radau_iia:2,radau_iia:2", "radau_iia:two"}) {
    const auto refused = parse_schemes(wrong);
    ASSERT_FALSE(refused) << wrong;
    EXPECT_NE(refused.error().message.find("expected"), std::string::npos) << wrong;
  }
}

TEST(Order, StepsAreRead) {
  EXPECT_EQ(*parse_steps("10,20,40"), (std::vector<long>{10, 20, 40}));
  for (const auto* wrong : {"", "10", "20,10", "10,10", "0,10", "10,x", "10,20,"}) {
    EXPECT_FALSE(parse_steps(wrong)) << wrong;
  }
}

TEST(Order, TheSlopeOfAPowerIsItsExponent) {
  const std::vector<double> steps{0.4, 0.2, 0.1, 0.05};
  std::vector<double> errors;
  for (const double h : steps) errors.push_back(7.0 * std::pow(h, 3.5));
  EXPECT_NEAR(*fitted_slope(steps, errors, 0.0), 3.5, 1e-12);
}

TEST(Order, ErrorsAtTheFloorAreNoPartOfTheSlope) {
  const std::vector<double> steps{0.4, 0.2, 0.1, 0.05, 0.025};
  std::vector<double> errors;
  for (const double h : steps) errors.push_back(std::max(std::pow(h, 5.0), 1e-6));
  EXPECT_NEAR(*fitted_slope(steps, errors, 1e-6), 5.0, 1e-12);
  EXPECT_LT(*fitted_slope(steps, errors, 0.0), 4.9);
  EXPECT_FALSE(fitted_slope(steps, errors, 5e-3));  // one is left
  EXPECT_FALSE(fitted_slope(std::vector{0.1, 0.1}, std::vector{1.0, 2.0}, 0.0));
}

/// x = 1 + h^2, switches at 1 + h^3; without switch detection of order 1, and one switch is missed at long steps.
TEST(Order, ARunnerOfKnownErrorsGivesTheirOrders) {
  result::OrderStudy study;
  study.series = {{"fesd", "radau_iia", 2, "step", {}, {}, {}}, {"timestepping", "radau_iia", 2, "step", {}, {}, {}}};
  const auto reference = finished({1.0, 0.0}, {1.0, 1.5});
  const std::vector<long> steps{4, 8, 16};
  const auto run = [](const OrderSeries& series, long count) -> Expected<Result> {
    const double h = 2.0 / (3.0 * static_cast<double>(count));
    const bool detects = series.method == "fesd";
    auto r = finished({1.0, detects ? h * h : h}, {1.0 + h * h * h, 1.5});
    if (!detects && count == 4) r.events.pop_back();
    r.options = {{"simulate.fesd.elements", std::int64_t{3}}, {"simulate.timestepping.elements", std::int64_t{3}}};
    return r;
  };
  measure(study, reference, steps, run);
  EXPECT_NEAR(*study.series[0].slope, 2.0, 1e-9);
  EXPECT_NEAR(*study.series[0].switch_time_slope, 3.0, 1e-9);
  EXPECT_NEAR(*study.series[1].slope, 1.0, 1e-9);
  EXPECT_NEAR(study.series[0].points[1].mean_step, 2.0 / 24.0, 1e-15);
  EXPECT_FALSE(study.series[1].points[0].switch_time_error.has_value());
  EXPECT_TRUE(study.series[1].points[1].switch_time_error.has_value());
}

TEST(Order, FailuresAreReasonsAndTheOthersGoOn) {
  result::OrderStudy study;
  study.series = {{"fesd", "radau_iia", 1, "step", {}, {}, {}}};
  const auto reference = finished({1.0}, {});
  const auto run = [](const OrderSeries&, long count) -> Expected<Result> {
    if (count == 1) return tl::unexpected(Error{ErrorCode::not_available, "not for this model", "", {}, {}});
    auto r = finished({1.0 + 1.0 / static_cast<double>(count)}, {});
    if (count == 2) r.status = {result::Termination::not_converged, "no solution", 0.5};
    return r;
  };
  measure(study, reference, std::vector<long>{1, 2, 4, 8}, run);
  const auto& series = study.series[0];
  EXPECT_EQ(series.points[0].reason, "not for this model");
  EXPECT_NE(series.points[1].reason.find("not_converged at t = 0.5: no solution"), std::string::npos);
  EXPECT_FALSE(series.points[1].error.has_value());
  EXPECT_NEAR(*series.slope, 1.0, 1e-12);
  EXPECT_FALSE(series.switch_time_slope.has_value());  // there are no switches
}

}  // namespace
}  // namespace saltus::pipeline
