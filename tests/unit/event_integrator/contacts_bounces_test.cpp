// Bounces that accumulate where a body moves along the ground, too: impulses that vanish have no friction.
#include <cmath>

#include "run_model.hpp"

namespace saltus::event_integrator::testing {
namespace {

using casadi::SX;
using result::ContactMode;
using result::EventKind;

constexpr double bounce_gravity = 9.81, bounce_friction = 0.1;

/// Falls from rest at the height 1.
double end_of_bounces(double restitution, double gravity) {
  return std::sqrt(2.0 / gravity) * (1.0 + restitution) / (1.0 - restitution);
}

/// Returns the only accumulation.
result::Event accumulation_of(const Integration& run) {
  std::vector<result::Event> found;
  for (const auto& event : run.events) {
    if (event.kind == EventKind::accumulation) found.push_back(event);
  }
  EXPECT_EQ(found.size(), 1U);
  return found.empty() ? result::Event{} : found.front();
}

/// Where a ball is that each impact slows by friction (1 + restitution) |vz|.
double way_through_bounces(double speed, double restitution, double end) {
  double x = 0.0, t = std::sqrt(2.0 / bounce_gravity), normal = std::sqrt(2.0 * bounce_gravity), duration = t;
  for (int n = 0; n < 400 && t < end; ++n) {
    x += speed * duration;
    speed -= std::copysign(bounce_friction, speed) * (1.0 + restitution) * normal;
    normal *= restitution;
    duration = 2.0 * normal / bounce_gravity;
    t += duration;
  }
  return x;
}

/// All normal impulses together are those of the weight, so v = speed - friction g t behind the bounces.
TEST(ContactBounces, ABallSlidesOnBehindTheLastOne) {
  for (const auto method : every_method) {
    for (const double restitution : {0.1, 0.5, 0.8}) {
      for (const double speed : {6.0, -7.0}) {
        SCOPED_TRACE(::testing::Message() << static_cast<int>(method) << " " << restitution << " " << speed);
        model::Builder model("ball");
        static_cast<void>(model.state("x", {0.0}));
        const SX z = model.state("z", {1.0});
        static_cast<void>(model.state("vx", {speed}));
        static_cast<void>(model.state("vz", {0.0}));
        model.mechanics({.positions = {"x", "z"}, .velocities = {"vx", "vz"}, .potential = bounce_gravity * z});
        model.contact("ground", z, {.tangent = {{"x", 1.0}}, .friction = bounce_friction, .restitution = restitution});
        IntegrationOptions options;
        options.method = method;
        options.tolerances = {1e-10, 1e-12};
        options.until = 8.0;
        const auto run = run_model(model, options);
        ASSERT_EQ(run.status.termination, result::Termination::completed) << run.status.message;
        const double end = end_of_bounces(restitution, bounce_gravity), sign = std::copysign(1.0, speed);
        const double left = std::abs(speed) - bounce_friction * bounce_gravity * end;
        const auto event = accumulation_of(run);
        ASSERT_EQ(event.x_after.size(), run.final.x.size());
        EXPECT_NEAR(event.t, end, 1e-7);
        EXPECT_NEAR(event.x_after[2], sign * left, 1e-6);
        EXPECT_NEAR(event.x[2], sign * left, 1e-6);
        EXPECT_EQ(event.contact_modes_after, std::vector<ContactMode>{ContactMode::slip});
        EXPECT_EQ(run.final.contact_modes, std::vector<ContactMode>{ContactMode::stick});
        EXPECT_EQ(run.events.back().kind, EventKind::stick);
        EXPECT_NEAR(run.events.back().t, std::abs(speed) / (bounce_friction * bounce_gravity), 1e-6);
        EXPECT_NEAR(run.final.x[0],
                    way_through_bounces(speed, restitution, end) +
                        sign * 0.5 * left * left / (bounce_friction * bounce_gravity),
                    1e-5);
      }
    }
  }
}

/// Under a force along its way v changes by (force - friction weight) t, in the direction in which it was.
TEST(ContactBounces, InSpaceASlideKeepsItsDirection) {
  for (const double restitution : {0.2, 0.6}) {
    for (const double angle : {0.0, 0.7, -2.0}) {
      SCOPED_TRACE(::testing::Message() << restitution << " " << angle);
      const double c = std::cos(angle), s = std::sin(angle), speed = 5.0;
      model::Builder model("ball");
      static_cast<void>(model.state("x", {0.0}));
      static_cast<void>(model.state("y", {0.0}));
      const SX z = model.state("z", {1.0});
      static_cast<void>(model.state("vx", {speed * c}));
      static_cast<void>(model.state("vy", {speed * s}));
      static_cast<void>(model.state("vz", {0.0}));
      model.mechanics({.positions = {"x", "y", "z"},
                       .velocities = {"vx", "vy", "vz"},
                       .force = {{"vx", 2.0 * c}, {"vy", 2.0 * s}, {"vz", -8.0}}});
      model.contact(
          "ground", z,
          {.tangent = {{"x", 1.0}}, .friction = 0.5, .restitution = restitution, .second_tangent = {{"y", 1.0}}});
      const double end = end_of_bounces(restitution, 8.0);
      const auto run = run_tightly(model, end + 0.3);
      ASSERT_EQ(run.status.termination, result::Termination::completed) << run.status.message;
      const auto event = accumulation_of(run);
      ASSERT_EQ(event.x_after.size(), run.final.x.size());
      EXPECT_NEAR(event.t, end, 1e-7);
      EXPECT_NEAR(event.x_after[3], c * (speed + (2.0 - 0.5 * 8.0) * end), 1e-6);
      EXPECT_NEAR(event.x_after[4], s * (speed + (2.0 - 0.5 * 8.0) * end), 1e-6);
      EXPECT_EQ(event.contact_modes_after, std::vector<ContactMode>{ContactMode::slip});
      EXPECT_NEAR(run.final.x[3], c * (speed - 2.0 * (end + 0.3)), 1e-6);
      EXPECT_NEAR(run.final.x[4], s * (speed - 2.0 * (end + 0.3)), 1e-6);
    }
  }
}

}  // namespace
}  // namespace saltus::event_integrator::testing
