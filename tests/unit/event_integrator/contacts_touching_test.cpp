// Gaps that close or open with no velocity and no acceleration.
#include "run_model.hpp"

namespace saltus::event_integrator::testing {
namespace {

using casadi::SX;
using result::ContactMode;
using result::EventKind;

Integration run_by(model::Builder& model, ode::Method method) {
  IntegrationOptions options;
  options.method = method;
  options.until = 2.0;
  return run_model(model, options);
}

constexpr auto methods = {ode::Method::dopri5, ode::Method::dop853, ode::Method::radau5};

/// The height (1 - t)^n comes to 0 so flatly that its rounding leaves the time open, and the speed there with it.
TEST(ContactsThatTouch, AFlatApproachIsOneTouchWithoutAnImpact) {
  for (const int n : {3, 5}) {
    for (const double restitution : {0.0, 0.5}) {
      for (const auto method : methods) {
        SCOPED_TRACE(::testing::Message() << n << " " << restitution << " " << static_cast<int>(method));
        model::Builder model("body");
        const SX z = model.state("z", {1.0});
        static_cast<void>(model.state("v", {-static_cast<double>(n)}));
        const SX left = 1.0 - model.time();
        model.mechanics(
            {.positions = {"z"}, .velocities = {"v"}, .force = {{"v", n * (n - 1.0) * pow(left, n - 2.0)}}});
        model.contact("ground", z, {.restitution = restitution});
        const auto run = run_by(model, method);
        ASSERT_EQ(run.status.termination, result::Termination::completed) << run.status.message;
        ASSERT_EQ(run.events.size(), 1U);
        EXPECT_EQ(run.events[0].kind, EventKind::contact);
        EXPECT_NEAR(run.events[0].t, 1.0, 5e-3);
        EXPECT_EQ(run.final.contact_modes, std::vector<ContactMode>{ContactMode::closed});
        EXPECT_EQ(run.final.x[0], 0.0);
        EXPECT_EQ(run.final.x[1], 0.0);
      }
    }
  }
}

/// A force that ends with its first two derivatives 0 lifts off once.
TEST(ContactsThatTouch, AForceThatEndsFlatlyLiftsOffOnce) {
  for (const auto method : methods) {
    SCOPED_TRACE(static_cast<int>(method));
    model::Builder model("body");
    const SX z = model.state("z", {0.0});
    static_cast<void>(model.state("v", {0.0}));
    const SX s = model.time() - 1.0;
    model.mechanics({.positions = {"z"}, .velocities = {"v"}, .force = {{"v", s * s * s}}});
    model.contact("ground", z);
    const auto run = run_by(model, method);
    ASSERT_EQ(run.status.termination, result::Termination::completed) << run.status.message;
    ASSERT_EQ(run.events.size(), 1U);
    EXPECT_EQ(run.events[0].kind, EventKind::lift_off);
    EXPECT_NEAR(run.events[0].t, 1.0, 1e-5);
    EXPECT_NEAR(run.final.x[0], 0.05, 1e-9);
  }
}

}  // namespace
}  // namespace saltus::event_integrator::testing
