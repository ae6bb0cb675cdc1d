// Surfaces and conditions of jumps that a decaying state tends to, and never reaches.
#include <string>

#include "run_model.hpp"

namespace saltus::event_integrator {
namespace {

using casadi::SX;
using model::Builder;
using result::Termination;

constexpr double decay_rates[] = {1.0, 5.0, 40.0};

/// Until exp(-600): doubles end at exp(-745).
void expect_no_event(Builder& builder, ode::Method method, double rate, double tolerance) {
  const auto what =
      std::to_string(static_cast<int>(method)) + " " + std::to_string(rate) + " " + std::to_string(tolerance);
  IntegrationOptions options;
  options.method = method;
  options.tolerances = {tolerance, 0.01 * tolerance};
  options.until = 600.0 / rate;
  const auto run = testing::run_model(builder, options);
  EXPECT_EQ(run.status.termination, Termination::completed) << what << ": " << run.status.message;
  EXPECT_EQ(run.events.size(), 0U) << what;
}

/// A step that is too long for what decays ends beyond zero, where the field would not have gone.
TEST(Decay, ASurfaceIsNotReached) {
  for (const auto method : testing::every_method) {
    for (const double rate : decay_rates) {
      for (const double tolerance : {1e-4, 1e-8, 1e-11}) {
        Builder b("decay");
        const SX v = b.state("v", {1.0});
        b.state("q", {0.0});
        b.dynamics("v", -rate * v);
        b.dynamics("q", b.sign(v));
        expect_no_event(b, method, rate, tolerance);
      }
    }
  }
}

TEST(Decay, AConditionOfAJumpDoesNotBecomeTrue) {
  for (const auto method : testing::every_method) {
    for (const double rate : decay_rates) {
      for (const double tolerance : {1e-4, 1e-8, 1e-11}) {
        Builder b("decay");
        const SX v = b.state("v", {1.0});
        const SX n = b.state("n", {0.0});
        b.dynamics("v", -rate * v);
        b.dynamics("n", 0.0);
        b.jump(model::less(v, 0.0), {{"n", n + 1.0}});
        expect_no_event(b, method, rate, tolerance);
      }
    }
  }
}

}  // namespace
}  // namespace saltus::event_integrator
