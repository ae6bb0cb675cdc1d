// The step that a piece of the solution starts with.
#include "saltus/event_integrator/step_memory.hpp"

#include <gtest/gtest.h>

#include "saltus/event_integrator/integrate.hpp"
#include "systems.hpp"

namespace saltus::event_integrator {
namespace {

TEST(StepMemory, GivesWhatTheFirstStepInTheModeProposed) {
  StepMemory memory;
  EXPECT_EQ(memory.change({1}, 0.0, 0.1), 0.1);
  memory.accepted(0.3);
  memory.accepted(0.7);
  EXPECT_EQ(memory.change({0}, 2.0, 0.5), 0.5);
  EXPECT_EQ(memory.change({1}, 3.0, 0.5), 0.3);
  EXPECT_EQ(memory.change({0}, 4.0, 0.6), 0.6) << "no step was accepted in it";
}

TEST(StepMemory, IsNotLongerThanTheModeLasted) {
  StepMemory memory;
  EXPECT_EQ(memory.change({0}, 1.0, 0.1), 0.1);
  memory.accepted(100.0);
  EXPECT_EQ(memory.change({1}, 1.5, 0.2), 0.2);
  EXPECT_EQ(memory.change({0}, 2.0, 0.2), 1.25 * 0.5);
}

TEST(StepMemory, ForgetsTheOldestOfManyModes) {
  StepMemory memory;
  for (int mode = 0; mode < 33; ++mode) {
    EXPECT_EQ(memory.change({mode}, mode, 0.1), 0.1);
    memory.accepted(0.01 * (mode + 1));
  }
  EXPECT_EQ(memory.change({1}, 33.0, 0.1), 0.02);
  EXPECT_EQ(memory.change({0}, 34.0, 0.1), 0.1);
}

/// An oscillator that is a hundred times faster on one side, and damped on none.
TEST(StepMemory, ComingBackToAModeRejectsHardlyAnyStep) {
  auto s = testing::blank(2, 1);
  testing::add_surface(s, "x", s.x(0));
  testing::set_field(s, {s.x(1), -(1 + 9999 * s.alpha(0)) * s.x(0)}, {0.0, 1.0});
  auto kernel = evaluation::ModelKernel::compile(s);
  ASSERT_TRUE(kernel.has_value());
  for (const auto method : {ode::Method::dopri5, ode::Method::dop853}) {
    IntegrationOptions options;
    options.method = method;
    options.tolerances = {1e-8, 1e-10};
    options.until = 200.0;
    const auto result = integrate(*kernel, s, options);
    ASSERT_EQ(result.status.termination, result::Termination::completed);
    ASSERT_GT(result.events.size(), 120U);
    // The fast side costs about one at its steepest; starting it with the step of the slow side, four more.
    EXPECT_LT(result.statistics.rejected, 2 * static_cast<long>(result.events.size()));
  }
}

}  // namespace
}  // namespace saltus::event_integrator
