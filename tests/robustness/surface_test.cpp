// Solutions stay on the surfaces they slide on: exactly on coordinate surfaces, within the tolerance on curved ones.
#include <algorithm>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "problems/references.hpp"
#include "problems/simulator.hpp"

namespace saltus::problems {
namespace {

TEST(Surfaces, StuckBlocksHaveVelocityZeroExactly) {
  const Simulator model = Simulator::from_reference(reference("friction-blocks"));
  for (const Accuracy& accuracy : {standard, fine, Accuracy{pipeline::Integrator::dopri5, 1e-3, 1e-5}}) {
    pipeline::SimulateOptions options = with(model.options(), accuracy);
    options.output = pipeline::NumberOfPoints{5001};
    const result::Result result = model.run(options);
    ASSERT_EQ(result.trajectory.t.size(), result.trajectory.mode.size());
    int stuck_rows = 0;
    for (std::size_t row = 0; row < result.trajectory.t.size(); ++row) {
      for (std::size_t block = 0; block < 3; ++block) {
        if (result.trajectory.mode[row][block] != 0) continue;
        ++stuck_rows;
        EXPECT_EQ(result.trajectory.x[row][3 + block], 0.0) << "t = " << result.trajectory.t[row];
      }
    }
    EXPECT_GT(stuck_rows, 3 * 3000);  // from t = 3.5…3.9 of 12 on
    for (std::size_t i = 3; i < 6; ++i) EXPECT_EQ(result.final.x[i], 0.0);
  }
}

TEST(Surfaces, StickingMassRestsExactly) {
  const Simulator model = Simulator::from_reference(reference("dry-friction-oscillator"));
  const result::Result result = model.run(model.options());
  ASSERT_FALSE(result.events.empty());
  EXPECT_EQ(result.final.x[1], 0.0);
  EXPECT_EQ(result.final.x[0], result.events.back().x_after[0]);  // v is exactly 0, so x does not move
}

double distance_from_circle(const std::vector<double>& x) { return std::abs(x[0] * x[0] + x[1] * x[1] - 1.0); }

TEST(Surfaces, DenseOutputBetweenLongStepsStaysNearACurvedSurface) {
  const Simulator model = Simulator::from_reference(reference("circle"));
  for (const Accuracy& accuracy : {standard, fine}) {
    pipeline::SimulateOptions options = with(model.options(), accuracy);
    options.output = pipeline::NumberOfPoints{3001};
    const result::Result result = model.run(options);
    ASSERT_EQ(result.events.size(), 1u);
    const double tolerance = 2.0 * (options.atol + options.rtol);
    for (std::size_t row = 0; row < result.trajectory.t.size(); ++row) {
      if (result.trajectory.mode[row][0] != 0) continue;
      // dense output is of lower order than the steps: a hundred tolerances
      EXPECT_LT(distance_from_circle(result.trajectory.x[row]), 100 * tolerance) << result.trajectory.t[row];
    }
  }
}

}  // namespace
}  // namespace saltus::problems
