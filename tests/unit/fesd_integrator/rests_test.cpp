// Functions that rest at zero while another one is held there, and elements behind which they are still zero.
#include "saltus/fesd_integrator/decide/rests.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "compiled.hpp"
#include "saltus/fesd_integrator/decide/transition.hpp"
#include "saltus/fesd_integrator/element/element.hpp"

namespace saltus::fesd_integrator {
namespace {

using casadi::SX;
using Modes = std::vector<int>;
using Surfaces = std::vector<Surface>;

/// A point on the unit circle in frozen time: pressed against it from outside by gravity towards the centre, speed 1.
/// Functions: the gap, its rate.
Compiled on_the_circle(reformulation::Form form = reformulation::Form::step) {
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
  return Compiled(builder, form);
}

/// A ball in frozen time: y is how deep it is in the ground that stops it, and then drives it back with less force.
/// Functions: the gap, its rate.
Compiled ball(reformulation::Form form) {
  model::Builder builder("ball");
  const SX z = builder.state("z", {0.0}), v = builder.state("v", {0.0}), y = builder.state("y", {0.0});
  const SX open = builder.step(builder.switching("gap", z + y)), opens = builder.step(builder.switching("rate", v));
  builder.dynamics("z", v * open);
  builder.dynamics("v", -10.0 * open + 100.0 * (1.0 - open) * (1.0 - 0.75 * opens));
  builder.dynamics("y", v * (1.0 - open));
  return Compiled(builder, form);
}

TEST(Rests, AGapRestsOnItsRate) {
  const Compiled model = on_the_circle();
  Rests rests(model.kernel, model.facts.parts);
  const std::vector<double> x{1.0, 0.0, 0.0, 1.0};
  rests.find({0.0, x, nullptr, 1.0}, {0, 1});
  EXPECT_EQ(rests.governor(0), 1);
  EXPECT_EQ(rests.governor(1), -1);
  const auto resting = [&](const Modes& modes) {
    ActiveSet set = model.set(modes);
    rests.put_into(set);
    return set.resting();
  };
  EXPECT_EQ(resting({-1, 0}), Surfaces{{0}});
  EXPECT_TRUE(resting({-1, 1}).empty());
  for (const Modes& modes : {Modes{1, 1}, Modes{-1, -1}, Modes{-1, 0}}) EXPECT_TRUE(rests.allow({0, 1}, modes));
  for (const Modes& modes : {Modes{1, -1}, Modes{-1, 1}, Modes{1, 0}, Modes{0, 0}, Modes{0, 1}}) {
    EXPECT_FALSE(rests.allow({0, 1}, modes));
  }
}

TEST(Rests, WhatActsOnBothSidesOfARateHoldsIt) {
  const Compiled model = ball(reformulation::Form::step);
  Rests rests(model.kernel, model.facts.parts);
  const std::vector<double> at_rest{0.0, 0.0, 0.0};
  rests.find({0.0, at_rest, nullptr, 1.0}, {0, 1});
  EXPECT_EQ(rests.governor(0), 1);
  for (const Modes& modes : {Modes{1, 1}, Modes{-1, -1}, Modes{0, 0}}) EXPECT_TRUE(rests.allow({0, 1}, modes));
  for (const Modes& modes : {Modes{1, -1}, Modes{-1, 0}, Modes{1, 0}, Modes{0, 1}}) {
    EXPECT_FALSE(rests.allow({0, 1}, modes));
  }
  ActiveSet set = model.set({0, 0});
  rests.put_into(set);
  EXPECT_EQ(set.resting(), Surfaces{{0}});
  ASSERT_EQ(set.sliding().size(), 1U);
  EXPECT_EQ(set.sliding()[0].selection, 0);
  EXPECT_EQ(set.sliding()[0].surface, Surface{1});
  EXPECT_EQ(set.conditions().size(), 2U);
  ElementSolver solver(model.kernel, tableau(discretization::TableauFamily::radau_iia, 2));
  const auto found = Transition(model.kernel, model.facts.parts, solver)
                         .continuations({.x = at_rest, .size = 1.0, .trial_length = 1e-3});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found.front().set.modes(), (Modes{0, 0}));
  EXPECT_TRUE(found.front().determined);
  // 10 a = 100 (1 - a) (1 - 0.75 / 2)
  EXPECT_NEAR(found.front().selections[0], 6.25 / 7.25, 1e-12);
}

TEST(Rests, RegionsOnOneSideOfARateHoldIt) {
  const Compiled model = ball(reformulation::Form::stewart);
  const std::vector<double> at_rest{0.0, 0.0, 0.0};
  ElementSolver solver(model.kernel, tableau(discretization::TableauFamily::radau_iia, 2));
  const auto found = Transition(model.kernel, model.facts.parts, solver)
                         .continuations({.x = at_rest, .size = 1.0, .trial_length = 1e-3});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_TRUE(found.front().determined);
  // Regions: above, first with a rate above 0. What closes has the larger force.
  const ActiveSet& set = found.front().set;
  EXPECT_EQ(set.modes(), (Modes{-1, 0, -1, 0}));
  EXPECT_EQ(set.resting(), (Surfaces{{1, 3}}));
  ASSERT_EQ(set.sliding().size(), 1U);
  const std::vector<double> g{-3.0, 1.0, -1.0, 3.0};  // at gap 1, rate 2
  EXPECT_EQ(set.surface(0, g.data()), -4.0);
  EXPECT_EQ(set.resting()[0].value(g.data()), 2.0);
  // 10 a = 100 (1 - a)
  EXPECT_NEAR(found.front().selections[1], 100.0 / 110.0, 1e-12);
  EXPECT_EQ(set.conditions().size(), 2U);  // those of the weights: the other regions have no side of their own
}

TEST(Rests, RegionsOfAGapThatRestsHaveNoSide) {
  const Compiled model = on_the_circle(reformulation::Form::stewart);
  const std::vector<double> x{1.0, 0.0, 0.0, 1.0};
  ElementSolver solver(model.kernel, tableau(discretization::TableauFamily::radau_iia, 2));
  const auto found =
      Transition(model.kernel, model.facts.parts, solver).continuations({.x = x, .size = 1.0, .trial_length = 1e-3});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found.front().set.modes(), (Modes{-1, -1, 0, 0}));
  EXPECT_EQ(found.front().set.resting(), (Surfaces{{0, 2}}));
  EXPECT_EQ(found.front().set.conditions().size(), 2U);
}

TEST(Rests, WhatActsOnItsOwnDoesNotRest) {
  // x'' = -sign x - sign v / 2: the rate of x is v, but x acts whatever the side of v is.
  model::Builder builder("friction");
  const SX x = builder.state("x", {0.0}), v = builder.state("v", {0.0});
  builder.dynamics("x", v);
  builder.dynamics("v", -builder.sign(x) - 0.5 * builder.sign(v));
  const Compiled model(builder);
  Rests rests(model.kernel, model.facts.parts);
  const std::vector<double> at_rest{0.0, 0.0};
  rests.find({0.0, at_rest, nullptr, 1.0}, {0, 1});
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
  set.set_resting({{0}}, {0});
  EXPECT_EQ(set.conditions().size(), 2U);  // those of the selection of the rate
  EXPECT_NEAR(gap_behind(set), 0.0, 1e-15);
}

}  // namespace
}  // namespace saltus::fesd_integrator
