// Regions by indicator that meet on a switching surface which influences them, against closed forms.
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "run_model.hpp"

namespace saltus::event_integrator {
namespace {

using casadi::SX;
using model::Builder;
using result::EventKind;
using result::Regions;
using result::Termination;
using testing::run_tightly;

/// Sectors of 120 degrees in (x, y) whose fields point to the axis x = y = 0, and a surface z = 0 with the selection
/// alpha: x' = -c_i + alpha/2 e_x, z' = a_i + w - 2 alpha, a = (1.2, 0.6, 0.6), w = max(t - 4, 0)/2. Where all meet
///   sum theta_i c_i = (alpha/2, 0):   theta = (1 + alpha, 1 - alpha/2, 1 - alpha/2)/3,
///   z' = 0.8 + 0.2 alpha + w - 2 alpha = 0:   alpha = (0.8 + w)/1.8,
/// which is 1 at t = 6; from there on z' = w - 1 and z = (t - 6)^2/4.
Integration sectors(std::array<double, 3> from, double scale, double until) {
  Builder b("sectors on a surface");
  const SX x = b.state("x", {from[0]});
  const SX y = b.state("y", {from[1]});
  const SX z = b.state("z", {from[2]});
  const SX alpha = b.step(scale * z, "z");
  b.dynamics("x", 0.5 * alpha);
  b.dynamics("z", b.max(b.time() - 4.0, 0.0) / 2.0 - 2.0 * alpha);
  for (std::size_t i = 0; i < 3; ++i) {
    const double angle = 2.0 * std::numbers::pi / 3.0 * static_cast<double>(i);
    const double c = std::cos(angle), s = std::sin(angle);
    b.region(-(c * x + s * y), {{"x", SX(-c)}, {"y", SX(-s)}, {"z", SX(i == 0 ? 1.2 : 0.6)}},
             std::array{"east", "north", "south"}.at(i));
  }
  return run_tightly(b, until);
}

TEST(RegionsOnSurface, HoldTheSolutionAndLetItGo) {
  // First to the axis, first to the surface, from below; psi in other units.
  const std::array<std::pair<std::array<double, 3>, double>, 4> runs{
      {{{0.5, 0.2, 2.0}, 1.0}, {{1.0, -0.4, 0.1}, 1.0}, {{0.5, 0.3, -1.5}, 1.0}, {{1.0, -0.4, 0.1}, 1e8}}};
  for (const auto& [from, scale] : runs) {
    const auto held = sectors(from, scale, 5.0);
    ASSERT_EQ(held.status.termination, Termination::completed) << from[2] << held.status.message;
    EXPECT_EQ(held.final.regions, (Regions{{"east", "north", "south"}})) << from[2];
    EXPECT_EQ(held.final.mode, (result::Mode{0})) << from[2];
    const double alpha = 1.3 / 1.8;
    EXPECT_NEAR(held.final.alpha[0], alpha, 1e-11) << from[2];
    EXPECT_NEAR(held.final.theta[0], (1.0 + alpha) / 3.0, 1e-11) << from[2];
    EXPECT_NEAR(held.final.theta[1], (1.0 - alpha / 2.0) / 3.0, 1e-11) << from[2];
    for (const auto& event : held.events) EXPECT_EQ(event.unique, true) << event.reason;
    const auto run = sectors(from, scale, 8.0);
    ASSERT_EQ(run.status.termination, Termination::completed) << from[2] << run.status.message;
    EXPECT_NEAR(run.events.back().t, 6.0, 1e-9) << from[2];
    EXPECT_EQ(run.events.back().surfaces, (std::vector<std::string>{"z"}));
    EXPECT_EQ(run.events.back().kind, EventKind::leave_sliding);
    EXPECT_EQ(run.final.regions, (Regions{{"east", "north", "south"}})) << from[2];
    EXPECT_NEAR(run.final.x[2], 1.0, 1e-9) << from[2];
    EXPECT_NEAR(std::hypot(run.final.x[0], run.final.x[1]), 0.0, 1e-12) << from[2];
  }
}

TEST(RegionsOnSurface, WhatTheModelDoesNotDetermineIsTold) {
  // In the plane the surface through the point where three regions meet has no gradient of its own.
  Builder b("plane");
  const SX x = b.state("x", {0.5});
  const SX y = b.state("y", {0.2});
  const SX alpha = b.step(x + 0.3 * y, "line");
  b.dynamics("x", 0.2 * alpha);
  for (std::size_t i = 0; i < 3; ++i) {
    const double angle = 2.0 * std::numbers::pi / 3.0 * static_cast<double>(i);
    const double c = std::cos(angle), s = std::sin(angle);
    b.region(-(c * x + s * y), {{"x", SX(-c)}, {"y", SX(-s)}});
  }
  const auto run = run_tightly(b, 4.0);
  EXPECT_EQ(run.status.termination, Termination::outside_class);
  EXPECT_NE(run.status.message.find("how wide the layer of the surface is"), std::string::npos) << run.status.message;
}

}  // namespace
}  // namespace saltus::event_integrator
