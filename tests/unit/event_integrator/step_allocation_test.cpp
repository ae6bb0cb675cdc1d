// No memory is allocated from step to step between events.
#include <gtest/gtest.h>

#include "../counted_allocations.hpp"
#include "saltus/event_integrator/integrate.hpp"
#include "systems.hpp"

namespace saltus::event_integrator {
namespace {

using saltus::testing::allocations;

struct Count {
  long steps = 0;            ///< from one step without event to the next
  long with_allocation = 0;  ///< of them
};

Count count(const model::System& system, ode::Method method, double until) {
  const auto kernel = evaluation::ModelKernel::compile(system);
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
  const auto result = integrate(*kernel, system, options, observer);
  EXPECT_EQ(result.status.termination, result::Termination::completed) << result.status.message;
  return count;
}

TEST(StepAllocation, NoneInClassicalMotionAndSliding) {
  for (const auto method : {ode::Method::dopri5, ode::Method::dop853, ode::Method::radau5}) {
    // Sticks (slides on v = 0.2) and slips, with an affine exit.
    const auto slips = count(testing::stick_slip(), method, 20.0);
    EXPECT_GT(slips.steps, 20) << static_cast<int>(method);
    EXPECT_EQ(slips.with_allocation, 0) << static_cast<int>(method);
  }
}

TEST(StepAllocation, NoneWhereEventFunctionsAreCurved) {
  for (const auto method : {ode::Method::dopri5, ode::Method::dop853}) {
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

}  // namespace
}  // namespace saltus::event_integrator
