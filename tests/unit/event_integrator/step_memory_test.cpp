// The step that a piece of the solution starts with.
#include "saltus/event_integrator/steps/step_memory.hpp"

#include <algorithm>
#include <cmath>

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
  for (const auto method : {ode::Method::dopri5, ode::Method::dop853, ode::Method::taylor}) {
    IntegrationOptions options;
    options.method = method;
    options.tolerances = {1e-8, 1e-10};
    options.until = 200.0;
    const auto result = integrate(*kernel, options);
    ASSERT_EQ(result.status.termination, result::Termination::completed);
    ASSERT_GT(result.events.size(), 120U);
    // The fast side costs about one at its steepest; starting it with the step of the slow side, four more.
    EXPECT_LT(result.statistics.rejected, 2 * static_cast<long>(result.events.size()));
  }
}

TEST(StepMemory, TheFirstStepOfANewModeIsAGuess) {
  StepMemory memory;
  EXPECT_TRUE(memory.is_guess()) << "before any mode";
  static_cast<void>(memory.change({0}, 0.0, 0.1));
  EXPECT_TRUE(memory.is_guess());
  memory.accepted(0.3);
  EXPECT_FALSE(memory.is_guess()) << "its second step";
  static_cast<void>(memory.change({1}, 1.0, 0.1));
  EXPECT_TRUE(memory.is_guess());
  static_cast<void>(memory.change({0}, 2.0, 0.1));
  EXPECT_FALSE(memory.is_guess()) << "remembered";
  static_cast<void>(memory.change({1}, 3.0, 0.1));
  EXPECT_TRUE(memory.is_guess()) << "no step was accepted in it";
}

/// x' = 1, y' = cos(w x + p) behind x = 0, where y = (sin(w x + p) - sin p) / w, and nothing before: the first step
/// behind the switch is tried with lengths that know nothing of w.
TEST(StepMemory, AnErrorEstimateThatVanishesByChanceIsNotBelieved) {
  auto s = testing::blank(4, 1);
  const auto x = s.x(0), w = s.x(2), p = s.x(3);
  testing::add_surface(s, "x", x);
  testing::set_field(s, {1, s.alpha(0) * cos(w * x + p), 0, 0}, {-1.0, 0.0, 1.0, 0.0});
  auto kernel = evaluation::ModelKernel::compile(s);
  ASSERT_TRUE(kernel.has_value());
  constexpr double rtol = 1e-8, end = 10.0;
  for (const auto method : {ode::Method::dopri5, ode::Method::dop853}) {
    double worst = 0.0;
    for (int k = 0; k < 4000; ++k) {
      const double frequency = std::pow(10.0, k / 4000.0), phase = std::fmod(0.618033988749895 * k, 1.0) * 2.0 * M_PI;
      kernel->set_initial_state({-1.0, 0.0, frequency, phase});
      IntegrationOptions options;
      options.method = method;
      options.tolerances = {rtol, rtol};
      options.until = 1.0 + end;
      const auto result = integrate(*kernel, options);
      ASSERT_EQ(result.status.termination, result::Termination::completed);
      const double exact = (std::sin(frequency * end + phase) - std::sin(phase)) / frequency;
      worst = std::max(worst, std::abs(result.final.x[1] - exact));
    }
    // Ten times the tolerance, as errors of steps are estimates. If no step is looked at twice, 40 rtol (dop853).
    EXPECT_LE(worst, 10 * rtol) << static_cast<int>(method);
  }
}

}  // namespace
}  // namespace saltus::event_integrator
