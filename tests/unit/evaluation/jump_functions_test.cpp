// The kernel's functions of [[jumps]].
#include <gtest/gtest.h>

#include "blank_system.hpp"
#include "saltus/evaluation/model_kernel.hpp"
#include "saltus/model/build.hpp"

namespace saltus::evaluation {
namespace {

using casadi::SX;

/// One switching function, an event with one guard and three jumps: a condition of two comparisons, times, a guard.
model::System jumping_example() {
  model::System s = blank_system(3.0, 1);
  model::SwitchingFunction surface;
  surface.psi = s.x(0);
  s.switching = {surface};
  s.f = SX::vertcat({s.x(1), s.alpha});
  s.f_as_written = s.f;
  s.outputs = SX(0, 1);
  model::UserEvent event;
  event.guards = s.x(1) - 7.0;
  event.guard_alpha = SX::sym("g", 1);
  event.value = event.guard_alpha;
  event.true_at_equality = {false};
  s.events = {event};
  model::Jump condition;
  condition.guards = SX::vertcat({s.x(0) - 1.0, s.u - s.x(1)});
  condition.guard_alpha = SX::sym("g", 2);
  condition.value = condition.guard_alpha(0) * (1.0 - condition.guard_alpha(1));
  condition.true_at_equality = {false, true};
  condition.targets = {1, 0};
  condition.values = SX::vertcat({s.x(0) + s.alpha * s.u, -s.x(1)});
  condition.priority = s.x(0) * s.p;
  condition.delay = s.t + s.u;
  model::Jump times;
  times.trigger = model::JumpTrigger::times;
  times.every = 0.5;
  times.guards = SX(0, 1);
  times.guard_alpha = SX(0, 1);
  times.targets = {0};
  times.values = SX(4.0);
  times.priority = SX(0.0);
  times.delay = SX(0.0);
  model::Jump guard = times;
  guard.trigger = model::JumpTrigger::guard_down;
  guard.guards = s.x(0) * s.x(1);
  s.jumps = {condition, times, guard};
  s.input_at_instant = s.input;
  return s;
}

TEST(JumpFunctions, AreNumberedBehindTheGuardsOfEventsAndEvaluated) {
  const auto kernel = ModelKernel::compile(jumping_example());
  ASSERT_TRUE(kernel.has_value());
  ASSERT_EQ(kernel->event_functions(), 5);
  EXPECT_EQ(kernel->jump_guard(0, 0), 2);
  EXPECT_EQ(kernel->jump_guard(0, 1), 3);
  EXPECT_EQ(kernel->jump_guard(2, 0), 4);
  const double t = 0.5, x[] = {2.0, 5.0}, alpha[] = {0.25};
  double phi[5];
  kernel->functions(t, x, alpha, phi);
  EXPECT_DOUBLE_EQ(phi[2], 1.0);
  EXPECT_DOUBLE_EQ(phi[3], 1.5 - 5.0);
  EXPECT_DOUBLE_EQ(phi[4], 10.0);
  double row[2], rate = 0.0;
  kernel->gradient(3, t, x, alpha, row, &rate);  // u - x1 with u = 3 t
  EXPECT_EQ(row[1], -1.0);
  EXPECT_EQ(rate, 3.0);
  const double holds[] = {1.0, 0.0}, fails[] = {1.0, 1.0};
  EXPECT_TRUE(kernel->jump_condition(0, t, x, alpha, holds));
  EXPECT_FALSE(kernel->jump_condition(0, t, x, alpha, fails));
  double values[2];
  kernel->jump_values(0, t, x, alpha, values);
  EXPECT_DOUBLE_EQ(values[0], 2.0 + 0.25 * 1.5);
  EXPECT_DOUBLE_EQ(values[1], -5.0);
  EXPECT_DOUBLE_EQ(kernel->jump_priority(0, t, x, alpha), 6.0);
  EXPECT_DOUBLE_EQ(kernel->jump_delay(0, t, x, alpha), 2.0);
  kernel->jump_values(1, t, x, alpha, values);
  EXPECT_EQ(values[0], 4.0);
}

}  // namespace
}  // namespace saltus::evaluation
