// What a tolerance means at the end of a run, through all events, and what the estimate of errors says of it.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <gtest/gtest.h>

#include "problems/references.hpp"
#include "problems/simulator.hpp"

namespace saltus::problems {
namespace {

using pipeline::Integrator;
using result::Result;
using result::Termination;

/// The largest error of the end state, relative to a hundredth and the state.
double error_at_end(const Result& result, const ReferenceProblem& problem) {
  double largest = 0.0;
  for (std::size_t i = 0; i < problem.final_x.size(); ++i) {
    const double exact = problem.final_x[i];
    largest = std::max(largest, std::abs(result.final.x[i] - exact) / (1e-2 + std::abs(exact)));
  }
  return largest;
}

// One bound for all models and tolerances: ten times rtol. Errors fall in proportion to it, through every event.
TEST(EndError, IsAtMostTenTolerances) {
  for (const auto& problem : references()) {
    const Simulator model = Simulator::from_reference(problem);
    for (const double rtol : {1e-4, 1e-6, 1e-8, 1e-10}) {
      const Result result = model.run(with(model.options(), {model.options().event.integrator, rtol, 1e-2 * rtol}));
      ASSERT_EQ(result.status.termination, Termination::completed) << problem.model << ": " << result.status.message;
      EXPECT_LE(error_at_end(result, problem), 10.0 * rtol + 1e-13) << problem.model << " at " << rtol;
    }
  }
}

// Within a factor of ten of the true error in 95 of 100 cases, where that is more than rounding.
TEST(EndError, IsEstimatedBySmallerTolerances) {
  std::size_t all = 0, good = 0;
  for (const auto& problem : references()) {
    const Simulator model = Simulator::from_reference(problem);
    auto options = with(model.options(), {model.options().event.integrator, 1e-6, 1e-8});
    options.error_estimate = true;
    const Result result = model.run(options);
    ASSERT_TRUE(result.error_estimate.has_value()) << problem.model;
    EXPECT_FALSE(result.error_estimate->parted_at.has_value()) << problem.model;
    EXPECT_EQ(result.error_estimate->x.size(), result.trajectory.t.size()) << problem.model;
    EXPECT_EQ(result.error_estimate->event_times.size(), result.events.size()) << problem.model;
    double estimated = 0.0;
    for (std::size_t i = 0; i < problem.final_x.size(); ++i) {
      const double size = 1e-2 + std::abs(problem.final_x[i]);
      estimated = std::max(estimated, result.error_estimate->final[i] / size);
    }
    constexpr double rounding = 1e-13;
    const double exact = error_at_end(result, problem);
    ++all;
    if (std::max(exact, estimated) <= rounding || (estimated >= 0.1 * exact && estimated <= 10.0 * exact)) ++good;
  }
  EXPECT_GE(static_cast<double>(good), 0.95 * static_cast<double>(all)) << good << " of " << all;
}

// Rows that are at events are compared with the same event of the second run, not with what is there at that time.
TEST(EndError, RowsAtEventsHaveTheErrorOfTheEvent) {
  const Simulator model = Simulator::from_catalogue("bouncing-ball");
  auto options = with(model.options(), {Integrator::dopri5, 1e-4, 1e-6});
  options.until = 2.0;
  options.error_estimate = true;
  const Result result = model.run(options);
  ASSERT_TRUE(result.error_estimate.has_value());
  ASSERT_GE(result.events.size(), 1u);
  for (std::size_t row = 0; row < result.error_estimate->x.size(); ++row) {
    for (const double error : result.error_estimate->x[row]) EXPECT_LT(error, 1e-2) << result.trajectory.t[row];
  }
}

}  // namespace
}  // namespace saltus::problems
