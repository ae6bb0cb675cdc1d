// A person's stop is heeded while one instant is resolved, not only behind a step.
#include <string>

#include <gtest/gtest.h>

#include "saltus/event_integrator/integrate.hpp"
#include "saltus/model/builder.hpp"

namespace saltus::event_integrator::testing {
namespace {

using casadi::SX;

/// Two jumps trigger each other at the start, ten thousand times before the run says so; each costs what four thousand
/// states cost.
TEST(StopInside, AnInstantThatLastsIsStopped) {
  model::Builder builder("ping-pong");
  const SX n = builder.discrete_state("n", 0.0);
  for (int i = 0; i < 4000; ++i) {
    const std::string name = "x" + std::to_string(i);
    builder.dynamics(name, -sin(builder.state(name, {1.0})));
  }
  builder.jump(model::less(n, 0.5), {{"n", 1.0}}, {.name = "ping", .at_start = true});
  builder.jump(model::greater(n, 0.5), {{"n", 0.0}}, {.name = "pong", .at_start = true});
  auto kernel = evaluation::ModelKernel::compile(*builder.build());
  ASSERT_TRUE(kernel.has_value());
  int asked = 0;
  IntegrationOptions options;
  options.until = 1.0;
  const auto run = integrate(*kernel, options, [&](const result::Progress&) {
    ++asked;
    return result::Continue::no;
  });
  EXPECT_EQ(run.status.termination, result::Termination::stopped_by_user) << run.status.message;
  EXPECT_EQ(run.status.message, "stopped at t = 0");
  EXPECT_EQ(asked, 1);
  EXPECT_FALSE(run.trajectory.t.empty());  // what there is is kept
}

}  // namespace
}  // namespace saltus::event_integrator::testing
