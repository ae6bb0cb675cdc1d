// Optima that are known exactly.
#include <algorithm>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "ocp_models.hpp"

namespace saltus::ocp_tests {
namespace {

using result::Termination;

TEST(OcpOptima, StewartAnitescuFromFiftyStarts) {
  // By quadrature: V(x0) = -x0^3/9 + (2 + x0/3)^3/3 + (1/3 + x0/3)^2.
  constexpr double x0 = -1.427572232082767;
  constexpr double optimum = 1.523772775374957;
  Stated problem = stated(stewart_anitescu("elements = 25\ncross_complementarity = \"fe_stage\"\n"));
  for (int i = 0; i < 50; ++i) {
    problem.ocp.system.initial_state[0] = -2.0 + 1.2 * i / 49.0;
    const auto result = optimized(problem);
    ASSERT_EQ(result.status.termination, Termination::completed) << i << ": " << result.status.message;
    EXPECT_NEAR(result.optimization->objective, optimum, 1e-9) << i;
    EXPECT_NEAR(result.optimization->nodes.front()[0], x0, 1e-9) << i;
  }
}

/// Every element in which the state crosses is a false optimum. Where little is smoothed, the start decides in which
/// one it ends; strong smoothing leads to one and the same, which is wrong by the order of the steps, too.
TEST(OcpOptima, StewartAnitescuWithoutSwitchDetectionStopsAtFalseOptima) {
  constexpr double optimum = 1.523772775374957;
  Stated problem = stated(stewart_anitescu("elements = 25\nswitch_detection = false\nverification_tolerance = 1\n"));
  for (const bool is_smoothed : {false, true}) {
    problem.options.mpcc.schedule.sigma_initial = is_smoothed ? 1.0 : 1e-3;
    double smallest = 10.0;
    double largest = 0.0;
    for (const double start : {-1.9, -1.6, -1.3, -1.0}) {
      problem.ocp.system.initial_state[0] = start;
      const auto result = optimized(problem);
      EXPECT_EQ(result.status.termination, Termination::completed) << result.status.message;
      smallest = std::min(smallest, result.optimization->objective);
      largest = std::max(largest, result.optimization->objective);
      EXPECT_GT(std::abs(result.optimization->objective - optimum), 0.01) << start;
    }
    EXPECT_EQ(largest - smallest > 0.05, !is_smoothed);
    EXPECT_EQ(largest - smallest < 1e-9, is_smoothed);
  }
}

/// x slides at 0 until t = 1 and leaves tangentially: x(1.5) = 1/8, whatever the control. An optimiser that may choose where
/// sliding ends leaves early, and finds 0.12 with a defect of 4 %.
TEST(OcpOptima, SlidingEndsWhereItHasTo) {
  for (const std::string form : {"scheme = \"radau_iia\"", "scheme = \"gauss_legendre\"", "reformulation = \"stewart\""}) {
    const auto result = optimized(stated(R"toml(
[model]
name = "leaving"
[states]
x = 0
[controls]
u = { lower = -1, upper = 1 }
[dynamics]
x = "t - sign(x)"
[optimize]
horizon = 1.5
control_intervals = 1
running_cost = "u^2"
terminal_cost = "x"
)toml" + form));
    EXPECT_EQ(result.status.termination, Termination::completed) << form << ": " << result.status.message;
    EXPECT_NEAR(result.optimization->objective, 0.125, 1e-10) << form;
    ASSERT_TRUE(result.optimization->verification) << form;
    EXPECT_LT(result.optimization->verification->interval_defect, 1e-10) << form;
  }
}

TEST(OcpOptima, TurboCar) {
  const auto result = optimized(stated(turbo_car(20, 10)));
  EXPECT_EQ(result.status.termination, Termination::completed) << result.status.message;
  EXPECT_NEAR(result.optimization->objective, 40.0 / 3.0, 1e-8);
  ASSERT_TRUE(result.optimization->verification);
  EXPECT_LT(result.optimization->verification->interval_defect, 1e-9);
}

TEST(OcpOptima, TurboCarOnGrids) {
  // Programs for the switching times of the exact flow.
  for (const auto& [intervals, optimum] : {std::pair{10, 12.0165871}, std::pair{20, 11.8151023}, std::pair{40, 11.8071442}}) {
    const auto result = optimized(stated(turbo_car(25, intervals)));
    EXPECT_EQ(result.status.termination, Termination::completed) << result.status.message;
    EXPECT_NEAR(result.optimization->objective, optimum, 1e-6 * optimum);
  }
}

}  // namespace
}  // namespace saltus::ocp_tests
