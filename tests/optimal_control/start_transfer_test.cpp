// Starts from a stored result of another grid: its elements are cut, those in which time stands still, too.
#include <memory>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "ocp_models.hpp"
#include "saltus/solver/certificate/classify.hpp"

namespace saltus::ocp_tests {
namespace {

using result::Termination;

/// A car whose turbo goes on at 15 and off at 10: fields are constant in every mode, and elements exact.
Stated hysteresis_car(int intervals, int elements, double transfer) {
  return stated(fmt::format(R"toml(
[model]
name = "car"
[states]
q = 0
v = {{ initial = 0, lower = 0, upper = 25 }}
[controls]
u = {{ lower = -5, upper = 5, initial = 4 }}
[dynamics]
q = "v"
v = "u*(1 + 2*turbo)"
[[hysteresis]]
name = "turbo"
input = "v"
on = 15
off = 10
[time_freezing]
speed = {{ lower = 0.1, upper = 100 }}
transfer = {2}
[optimize]
horizon = {{ free = true, initial = 10.5, lower = 1, upper = 50 }}
control_intervals = {0}
elements = {1}
stages = 2
start = "simulated"
minimize_time = true
terminal_constraints = ["q == 150", "v == 0"]
[optimize.initial_guess]
q = "75*(1 - cos(pi*t/10.5))"
v = "23*sin(pi*t/10.5)"
turbo = "(tanh(3*(t - 2.5)) - tanh(3*(t - 8.5)))/2"
u = "5*tanh(3*(5 - t))"
)toml",
                            intervals, elements, transfer));
}

TEST(OcpStartTransfer, ElementsOfOtherGridsAreCutExactly) {
  const auto coarse = std::make_shared<result::Result>(optimized(hysteresis_car(10, 3, 1)));
  ASSERT_EQ(coarse->status.termination, Termination::completed) << coarse->status.message;
  struct Grid {
    int intervals, elements;
    double transfer;
  };
  for (const auto& [intervals, elements, transfer] : {Grid{20, 4, 1}, Grid{10, 5, 1}, Grid{20, 3, 2}, Grid{40, 4, 4}}) {
    auto fine = hysteresis_car(intervals, elements, transfer);
    fine.options.start_from = coarse;
    const auto problem = pipeline::state_problem(fine.ocp, fine.options);
    ASSERT_TRUE(problem);
    const auto start = problem->problem->start();
    EXPECT_LT(solver::certificate::scaled_infeasibility(*problem->problem, start), 1e-6)
        << intervals << ": " << solver::certificate::worst_rows(*problem->problem, start, 1e-6);
    EXPECT_LT(solver::certificate::complementarity(*problem->problem, start), 1e-6) << intervals;
    EXPECT_NEAR(problem->problem->objective(start), coarse->optimization->objective, 1e-8) << intervals;
  }
}

}  // namespace
}  // namespace saltus::ocp_tests
