#include "saltus/ode/explicit/classical_step.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace saltus::ode {
namespace {

/// Error at t = 1 of x' = y + t, y' = -x, from (0, 0): x = 1 - cos t, y = sin t - t.
double error_with(int steps) {
  ClassicalStep step(2);
  std::vector<double> x{0.0, 0.0};
  const double h = 1.0 / steps;
  for (int k = 0; k < steps; ++k) {
    step.take(
        [](double t, const double* point, double* slope) {
          slope[0] = point[1] + t;
          slope[1] = -point[0];
        },
        k * h, h, x);
  }
  return std::hypot(x[0] - (1.0 - std::cos(1.0)), x[1] - (std::sin(1.0) - 1.0));
}

TEST(ClassicalStep, HasOrderFour) {
  for (const int steps : {8, 16, 32}) {
    EXPECT_NEAR(std::log2(error_with(steps) / error_with(2 * steps)), 4.0, 0.1) << steps;
  }
}

TEST(ClassicalStep, IsExactForCubicFunctionsOfTime) {
  ClassicalStep step(1);
  std::vector<double> x{2.0};
  step.take([](double t, const double*, double* slope) { *slope = 4.0 * t * t * t; }, 1.0, 2.0, x);
  EXPECT_DOUBLE_EQ(x[0], 2.0 + 81.0 - 1.0);
}

}  // namespace
}  // namespace saltus::ode
