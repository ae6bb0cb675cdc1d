// A million steps on a curved surface.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "problems/references.hpp"
#include "problems/simulator.hpp"

namespace saltus::problems {
namespace {

double distance_from_circle(const std::vector<double>& x) { return std::abs(x[0] * x[0] + x[1] * x[1] - 1.0); }

TEST(Drift, OffACurvedSurfaceStaysBelowTheToleranceOverAMillionSteps) {
  const Simulator model = Simulator::from_reference(reference("circle"));
  pipeline::SimulateOptions options = with(model.options(), {pipeline::Integrator::dopri5, 1e-6, 1e-8});
  options.until = 10000.0;
  options.event.max_step = 0.00999;
  options.max_steps = 2000000;
  options.output = pipeline::NumberOfPoints{20001};
  const result::Result result = model.run(options);
  ASSERT_EQ(result.status.termination, result::Termination::completed) << result.status.message;
  EXPECT_GE(result.statistics.steps, 1000000);
  ASSERT_EQ(result.events.size(), 1u);
  const double tolerance = 2.0 * (options.atol + options.rtol);  // |grad psi| = 2 on the circle, |x| = 1
  double worst = 0.0;
  for (std::size_t row = 0; row < result.trajectory.t.size(); ++row) {
    if (result.trajectory.mode[row][0] == 0) worst = std::max(worst, distance_from_circle(result.trajectory.x[row]));
  }
  EXPECT_LT(worst, tolerance);
  EXPECT_LT(distance_from_circle(result.final.x), 1e-14) << "the step ends are projected to rounding level";
}

}  // namespace
}  // namespace saltus::problems
