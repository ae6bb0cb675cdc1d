// Friction with roots of the velocity, beside others: surfaces with roots are reached, slid on together, and left.
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "problems/simulator.hpp"

namespace saltus::problems {
namespace {

using result::EventKind;
using result::Termination;

const std::vector<Accuracy> several_accuracies{standard, implicit, Accuracy{pipeline::Integrator::dop853, 1e-8, 1e-10},
                                               fine};

// Stuck up to t = 1, where the force exceeds 0.3; then v = (t - 1)^3, of which the root is t - 1.
TEST(FrictionRoots, ACubicRootIsLeft) {
  const Simulator simulator = Simulator::from_text(R"toml(
[model]
name = "cubic root"
[states]
v = 0
[dynamics]
v = "-(0.3 + abs(v)^(1/3))*sign(v) + 0.3 + (t - 1) + 3*(t - 1)^2"
[simulate]
from = 0.8
until = 2
)toml");
  for (const Accuracy& accuracy : several_accuracies) {
    const auto result = simulator.run(with(simulator.options(), accuracy));
    ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
    ASSERT_EQ(result.events.size(), 2U);
    EXPECT_EQ(result.events[1].kind, EventKind::leave_sliding);
    EXPECT_NEAR(result.events[1].t, 1.0, 1e-12);
    // The error of v decays, as the solution is stiff; it is that of some steps.
    EXPECT_NEAR(result.final.x[0], 1.0, 3.0 * accuracy.rtol);
  }
}

// Two masses that stick to each other, one of them on the ground: 2 v' = -1/2 - sqrt(v) for both, from 1. They come to
// rest at t = 2 int_0^1 dv/(1/2 + sqrt(v)) = 4 - 2 ln 3, and stay there.
TEST(FrictionRoots, TwoMassesThatStickComeToRest) {
  const Simulator simulator = Simulator::from_text(R"toml(
[model]
name = "two masses"
[states]
v = 1
w = 1
[switching]
together = "v - w"
rest = "w"
[dynamics]
v = "-(2 + sqrt(abs(together)))*sign(together)"
w = "(2 + sqrt(abs(together)))*sign(together) - (0.5 + sqrt(abs(rest)))*sign(rest)"
[simulate]
until = 3
)toml");
  for (const Accuracy& accuracy : several_accuracies) {
    const auto result = simulator.run(with(simulator.options(), accuracy));
    ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
    ASSERT_EQ(result.events.size(), 2U);
    EXPECT_EQ(*result.events[1].mode_after, (std::vector<int>{0, 0}));
    // The velocity changes by 1/4 per time there: four times its error, some steps of a tenth of the tolerance each.
    EXPECT_NEAR(result.events[1].t, 4.0 - 2.0 * std::log(3.0), 4.0 * accuracy.rtol);
    // What sliding keeps is a difference: its rounding, that of velocities of 1.
    EXPECT_NEAR(result.final.x[0], 0.0, 1e-16);
    EXPECT_EQ(result.final.x[1], 0.0);
  }
}

// A tank with a leak: it empties tangentially, at t = 2, and an inflow that stops below the leak keeps it empty.
TEST(FrictionRoots, ATankThatEmptiesTangentiallyIsEmptyInTime) {
  const Simulator simulator = Simulator::from_text(R"toml(
[model]
name = "tank"
[states]
h = 1
[dynamics]
h = "if(h > 0, -sqrt(abs(h)), 1)"
[simulate]
until = 3
)toml");
  for (const Accuracy& accuracy : several_accuracies) {
    const auto result = simulator.run(with(simulator.options(), accuracy));
    ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
    ASSERT_EQ(result.events.size(), 1U);
    EXPECT_EQ(result.events[0].kind, EventKind::enter_sliding);
    // sqrt(h) falls by 1/2 per time: what is left of h, a ten thousand millionth of atol, is emptied in 1e-8.
    EXPECT_NEAR(result.events[0].t, 2.0, 1e-7);
    EXPECT_EQ(result.final.x[0], 0.0);
  }
}

}  // namespace
}  // namespace saltus::problems
