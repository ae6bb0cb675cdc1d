// No memory is allocated from step to step between events.
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "../counted_allocations.hpp"
#include "saltus/event_integrator/integrate.hpp"
#include "saltus/model/builder.hpp"
#include "systems.hpp"

namespace saltus::event_integrator {
namespace {

using saltus::tests::allocations;

struct Count {
  long steps = 0;            ///< from one step without event to the next
  long with_allocation = 0;  ///< of them
};

Count count(const model::System& system, ode::Method method, double until) {
  auto kernel = evaluation::ModelKernel::compile(system);
  EXPECT_TRUE(kernel.has_value());
  IntegrationOptions options;
  options.method = method;
  options.until = until;
  options.output.rows = OutputTimes::Rows::at_times;  // rows are kept, and so need memory
  Count count;
  long seen = -1;
  long events = -1;
  long quiet = 0;
  const auto observer = [&](const Progress& progress) {
    // The first two steps of a mode fill what later ones use again.
    quiet = progress.events == events ? quiet + 1 : 0;
    if (quiet > 2 && progress.t < until) {  // the end has a row
      ++count.steps;
      count.with_allocation += allocations != seen ? 1 : 0;
    }
    events = progress.events;
    seen = allocations;
    return Continue::yes;
  };
  const auto result = integrate(*kernel, options, observer);
  EXPECT_EQ(result.status.termination, result::Termination::completed) << result.status.message;
  return count;
}

TEST(StepAllocation, NoneInClassicalMotionAndSliding) {
  for (const auto method : {ode::Method::dopri5, ode::Method::dop853, ode::Method::radau5, ode::Method::taylor}) {
    // Sticks (slides on v = 0.2) and slips, with an affine exit.
    const auto slips = count(testing::stick_slip(), method, 20.0);
    EXPECT_GT(slips.steps, 20) << static_cast<int>(method);
    EXPECT_EQ(slips.with_allocation, 0) << static_cast<int>(method);
  }
}

TEST(StepAllocation, NoneWhereEventFunctionsAreCurved) {
  for (const auto method : {ode::Method::dopri5, ode::Method::dop853, ode::Method::taylor}) {
    auto system = testing::blank(2, 1);
    const auto x = system.x(0);
    const auto y = system.x(1);
    testing::add_surface(system, "circle", x * x + y * y - 4.0);
    testing::set_field(system, {y, -x + 0.1 * system.alpha(0)}, {1.0, 0.0});
    const auto turns = count(system, method, 40.0);
    EXPECT_GT(turns.steps, 20);
    EXPECT_EQ(turns.with_allocation, 0) << static_cast<int>(method);
  }
}

TEST(StepAllocation, NoneWhereThreeRegionsHoldTheSolution) {
  for (const auto method : {ode::Method::dopri5, ode::Method::dop853, ode::Method::radau5, ode::Method::taylor}) {
    model::Builder b("moving point");
    const auto x = b.state("x", {0.5});
    const auto y = b.state("y", {0.0});
    const auto ahead = cos(b.time()) / 4.0 - x, beside = sin(b.time()) / 4.0 - y;
    for (int i = 0; i < 3; ++i) {
      const double c = std::cos(2.0 * std::numbers::pi / 3.0 * i), s = std::sin(2.0 * std::numbers::pi / 3.0 * i);
      b.region(-(c * ahead + s * beside), {{"x", casadi::SX(2.0 * c)}, {"y", casadi::SX(2.0 * s)}});
    }
    const auto system = b.build();
    ASSERT_TRUE(system.has_value());
    const auto held = count(*system, method, 20.0);
    EXPECT_GT(held.steps, 20) << static_cast<int>(method);
    EXPECT_EQ(held.with_allocation, 0) << static_cast<int>(method);
  }
}

// Four quadrants whose indicators depend on each other, with borders that turn.
TEST(StepAllocation, NoneWhereRegionsThatDependOnEachOtherHoldTheSolution) {
  for (const double turn : {0.0, 1.0}) {
    for (const auto method : {ode::Method::dopri5, ode::Method::dop853, ode::Method::radau5, ode::Method::taylor}) {
      model::Builder b("turning quadrants");
      const auto x = b.state("x", {0.3});
      const auto y = b.state("y", {0.2});
      const auto z = b.state("z", {0.0});
      const auto c = cos(turn * b.time()), s = sin(turn * b.time());
      for (int i = 0; i < 4; ++i) {
        const double right = (i & 1) != 0 ? 1.0 : -1.0, up = (i & 2) != 0 ? 1.0 : -1.0;
        const auto along = -2.0 * right + 0.3 * sin(b.time()), across = casadi::SX(-2.0 * up);
        b.region(-(right * (c * x + s * y) + up * (c * y - s * x)),
                 {{"x", c * along - s * across}, {"y", s * along + c * across}, {"z", cos(z + i)}});
      }
      const auto system = b.build();
      ASSERT_TRUE(system.has_value());
      const auto held = count(*system, method, 20.0);
      EXPECT_GT(held.steps, 20) << static_cast<int>(method);
      EXPECT_EQ(held.with_allocation, 0) << static_cast<int>(method) << ", " << turn;
    }
  }
}

}  // namespace
}  // namespace saltus::event_integrator
