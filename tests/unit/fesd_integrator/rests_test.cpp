// Functions that rest at zero while another one is held there, and elements behind which they are still zero.
#include "saltus/fesd_integrator/decide/rests.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "compiled.hpp"
#include "saltus/fesd_integrator/element/element.hpp"

namespace saltus::fesd_integrator {
namespace {

using casadi::SX;
using Modes = std::vector<int>;

/// A point on the unit circle in frozen time: pressed against it from outside by gravity towards the centre, speed 1.
/// Functions: the gap, its rate.
Compiled on_the_circle() {
  model::Builder builder("circle");
  const SX x = builder.state("x", {1.0}), y = builder.state("y", {0.0});
  const SX vx = builder.state("vx", {0.0}), vy = builder.state("vy", {1.0});
  const SX gap = builder.switching("gap", x * x + y * y - 1.0);
  const SX rate = builder.switching("rate", 2.0 * (x * vx + y * vy));
  const SX acts = (1.0 - builder.step(gap)) * (1.0 - builder.step(rate)), moves = 1.0 - acts;
  builder.dynamics("x", vx * moves);
  builder.dynamics("y", vy * moves);
  builder.dynamics("vx", -3.0 * x * moves + 20.0 * x * acts);
  builder.dynamics("vy", -3.0 * y * moves + 20.0 * y * acts);
  return Compiled(builder);
}

TEST(Rests, AGapRestsOnItsRate) {
  const Compiled model = on_the_circle();
  Rests rests(model.kernel);
  const std::vector<double> x{1.0, 0.0, 0.0, 1.0};
  rests.find({0.0, x, nullptr, 1.0}, model.facts.parts, {0, 1});
  EXPECT_EQ(rests.governor(0), 1);
  EXPECT_EQ(rests.governor(1), -1);
  EXPECT_EQ(rests.resting({-1, 0}), Modes{0});
  EXPECT_TRUE(rests.resting({-1, 1}).empty());
  for (const Modes& modes : {Modes{1, 1}, Modes{-1, -1}, Modes{-1, 0}}) EXPECT_TRUE(rests.allow({0, 1}, modes));
  for (const Modes& modes : {Modes{1, -1}, Modes{-1, 1}, Modes{1, 0}, Modes{0, 0}, Modes{0, 1}}) {
    EXPECT_FALSE(rests.allow({0, 1}, modes));
  }
}

TEST(Rests, WhatActsOnItsOwnDoesNotRest) {
  // x'' = -sign x - sign v / 2: the rate of x is v, but x acts whatever the side of v is.
  model::Builder builder("friction");
  const SX x = builder.state("x", {0.0}), v = builder.state("v", {0.0});
  builder.dynamics("x", v);
  builder.dynamics("v", -builder.sign(x) - 0.5 * builder.sign(v));
  const Compiled model(builder);
  Rests rests(model.kernel);
  const std::vector<double> at_rest{0.0, 0.0};
  rests.find({0.0, at_rest, nullptr, 1.0}, model.facts.parts, {0, 1});
  EXPECT_FALSE(rests.any());
}

TEST(Rests, ElementsEndWithWhatRestsAtZero) {
  const Compiled model = on_the_circle();
  const auto gap_behind = [&](const ActiveSet& set) {
    ElementSolver solver(model.kernel, tableau(discretization::TableauFamily::radau_iia, 2));
    Element element;
    EXPECT_EQ(solver.solve({0.0, {1.0, 0.0, 0.0, 1.0}, {0.0, 0.9}, 1.0}, 0.1, {&set, 1}, nullptr,
                           ElementSolver::Guess::left_end, element),
              ElementSolver::Outcome::solved);
    return std::hypot(element.end[0], element.end[1]) - 1.0;
  };
  ActiveSet set = model.set({-1, 0});
  EXPECT_GT(std::abs(gap_behind(set)), 1e-8);
  set.set_resting({0});
  EXPECT_EQ(set.conditions().size(), 2U);  // those of the selection of the rate
  EXPECT_NEAR(gap_behind(set), 0.0, 1e-15);
}

}  // namespace
}  // namespace saltus::fesd_integrator
