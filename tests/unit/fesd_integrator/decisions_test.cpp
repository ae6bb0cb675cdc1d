// What continues a solution at a point, what is held and until when, and how it is recorded.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "compiled.hpp"
#include "saltus/base/at.hpp"
#include "saltus/fesd_integrator/decide/transition.hpp"
#include "saltus/fesd_integrator/record/recorder.hpp"
#include "saltus/fesd_integrator/watch/held_values.hpp"

namespace saltus::fesd_integrator {
namespace {

using casadi::SX;
using discretization::TableauFamily;
using reformulation::Form;

std::vector<Continuation> continuations(const Compiled& model, double t, const std::vector<double>& x,
                                        std::optional<std::vector<int>> before, std::vector<int> at_zero) {
  ElementSolver solver(model.kernel, tableau(TableauFamily::radau_iia, 3));
  Transition transition(model.kernel, model.facts.parts, solver);
  std::optional<ActiveSet> set;
  if (before) set = model.set(*before);
  return transition.continuations({t, x, nullptr, set ? &*set : nullptr, at_zero, 1.0, 1e-3});
}

using Modes = std::vector<int>;

TEST(Transition, OneSurface) {
  struct Case {
    const char* what;
    double a, b, c, t;
    int before, after;
    double alpha;
  };
  const Case cases[] = {{"crosses", 2.0, 1.0, 0.0, 0.0, -1, 1, 1.0},
                        {"enters sliding", 0.2, 1.0, 0.0, 0.0, -1, 0, 0.6},
                        {"leaves sliding", 0.0, 1.0, 1.0, 1.0, 0, 1, 1.0},
                        {"goes on sliding", 0.0, 1.0, 1.0, 0.5, 0, 0, 0.75}};
  for (const auto& c : cases) {
    for (const Form form : {Form::step, Form::stewart}) {
      SCOPED_TRACE(c.what);
      const Compiled model = scalar(c.a, c.b, c.c, form);
      // Of the regions x > 0 and x < 0 those are active that are on the side of the mode.
      const auto modes = [&](int k) { return form == Form::step ? Modes{k} : Modes{k >= 0 ? 0 : -1, k <= 0 ? 0 : -1}; };
      const auto found = continuations(model, c.t, {0.0}, modes(c.before), form == Form::step ? Modes{0} : Modes{0, 1});
      ASSERT_EQ(found.size(), 1U);
      EXPECT_EQ(found[0].set.modes(), modes(c.after));
      EXPECT_NEAR(found[0].selections[0], c.alpha, 1e-12);
    }
  }
}

TEST(Transition, ASpontaneousSwitchHasThreeContinuations) {
  const Compiled model = scalar(0.0, -1.0);  // x' = sign x
  const auto found = continuations(model, 0.0, {0.0}, std::nullopt, {});
  ASSERT_EQ(found.size(), 3U);
  // At a start: above, below, sliding.
  EXPECT_EQ(found[0].set.modes(), Modes{1});
  EXPECT_EQ(found[1].set.modes(), Modes{-1});
  EXPECT_EQ(found[2].set.modes(), Modes{0});
}

TEST(Transition, TwoFunctionsThatAreZeroAtTheStartAreAskedBesideEachOther) {
  // v' = 1 - |v|, z' = v - |z| from (0, 0): v and z become positive, z to second order.
  model::Builder builder("at rest");
  const SX v = builder.state("v", {0.0});
  const SX z = builder.state("z", {0.0});
  builder.dynamics("v", 1.0 - v * builder.sign(v));
  builder.dynamics("z", v - z * builder.sign(z));
  for (const Form form : {Form::step, Form::stewart}) {
    const Compiled model(builder, form);
    const auto found = continuations(model, 0.0, {0.0, 0.0}, std::nullopt, {});
    ASSERT_GE(found.size(), 1U) << (form == Form::step ? "step" : "stewart");
    EXPECT_EQ(found[0].set.modes(), form == Form::step ? (Modes{1, 1}) : (Modes{0, -1, 0, -1}));
  }
}

TEST(Transition, WhatIsHeldAtTheStartIsFoundBesideWhatIsIdle) {
  // Heights and their rates in frozen time, with forces that stop the fall; w moves nothing.
  model::Builder builder("two bodies at rest");
  const SX y[] = {builder.state("y1", {0.0}), builder.state("y2", {0.0})};
  const SX v[] = {builder.state("v1", {0.0}), builder.state("v2", {0.0})};
  const SX far = builder.state("far", {1.0}), w = builder.state("w", {0.0});
  SX acts[2], moves = 1.0;
  for (int i = 0; i < 2; ++i) {
    acts[i] = (1.0 - builder.step(y[i])) * (1.0 - builder.step(v[i]));
    moves *= 1.0 - acts[i];
  }
  for (int i = 0; i < 2; ++i) {
    builder.dynamics(fmt::format("y{}", i + 1), v[i] * moves);
    builder.dynamics(fmt::format("v{}", i + 1), -10.0 * moves + 100.0 * acts[i]);
  }
  builder.dynamics("far", -0.1);
  builder.dynamics("w", (1.0 - builder.step(far)) * (1.0 - builder.step(w)));
  const Compiled model(builder);
  const auto found = continuations(model, 0.0, model.facts.initial_state, std::nullopt, {});
  ASSERT_FALSE(found.empty());
  for (const Continuation& each : found) {
    int closed = 0, held = 0;
    for (std::size_t j = 0; j < model.facts.selections.size(); ++j) {
      const char kind = model.facts.selections[j].name[0];
      closed += kind == 'y' && each.set.modes()[j] == -1 ? 1 : 0;
      held += kind == 'v' && each.set.modes()[j] == 0 ? 1 : 0;
    }
    EXPECT_EQ(std::pair(closed, held), std::pair(2, 2));
  }
}

TEST(Transition, AwayFromSurfacesTheSignsDecide) {
  const Compiled model = scalar(2.0, 1.0);
  const auto found = continuations(model, 0.0, {-0.4}, std::nullopt, {});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].set.modes(), Modes{-1});
}

/// x' = -2 sign x + b y-part, y' = -2 sign y + c x-part: coupled through their selections.
Compiled coupled(double b, double c) {
  model::Builder builder("coupled");
  const SX x = builder.state("x", {0.0});
  const SX y = builder.state("y", {0.0});
  const SX sx = builder.sign(x), sy = builder.sign(y);
  builder.dynamics("x", -2.0 * sx + b * sy);
  builder.dynamics("y", -2.0 * sy + c * sx);
  return Compiled(builder);
}

TEST(Transition, TwoSurfacesAreEnteredTogether) {
  // From sliding on x = 0 below y = 0: both are attractive for weak coupling.
  const auto found = continuations(coupled(0.5, -0.5), 0.0, {0.0, 0.0}, Modes{0, -1}, {0, 1});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].set.modes(), (Modes{0, 0}));
  EXPECT_NEAR(found[0].selections[0], 0.5, 1e-12);
  EXPECT_NEAR(found[0].selections[1], 0.5, 1e-12);
}

/// Two surfaces that influence each other meet, z' = factor sign x sign y beside them: in Stewart's form four weights
/// and three equations.
bool determined_at_the_corner(double factor, Form form) {
  model::Builder builder("corner");
  const SX x = builder.state("x", {0.0});
  const SX y = builder.state("y", {0.0});
  builder.state("z", {0.0});
  const SX sx = builder.sign(x), sy = builder.sign(y);
  builder.dynamics("x", -2.0 * sx + 0.5 * sy);
  builder.dynamics("y", -2.0 * sy - 0.5 * sx);
  builder.dynamics("z", factor * sx * sy);
  const auto found = continuations(Compiled(builder, form), 0.0, {0.0, 0.0, 0.0}, std::nullopt, {});
  EXPECT_FALSE(found.empty());
  return std::all_of(found.begin(), found.end(), [](const auto& other) { return other.determined; });
}

TEST(Transition, WeightsThatNoEquationHoldsAreTold) {
  EXPECT_TRUE(determined_at_the_corner(1.0, Form::step));
  EXPECT_FALSE(determined_at_the_corner(1.0, Form::stewart));
  // Nothing moves with the weight that is free.
  EXPECT_TRUE(determined_at_the_corner(0.0, Form::stewart));
}

/// Two bodies above the ground under a force g, stopped by a force a while time stands still: their gaps y and rates v,
/// and the clock.
Compiled two_contacts(double pull) {
  constexpr double a = 100.0, g = 10.0;
  model::Builder builder("two contacts");
  SX moves = 1.0;
  std::vector<SX> closed;
  for (const char* name : {"1", "2"}) {
    const SX y = builder.state(std::string("y") + name, {0.0}), v = builder.state(std::string("v") + name, {0.0});
    const SX gap = builder.step(y), rate = builder.step(v);
    moves *= gap + rate - gap * rate;
    closed.push_back((1.0 - gap) * (1.0 - rate));
    builder.dynamics(std::string("y") + name, v * moves);
  }
  builder.state("clock", {0.0});
  // An impulse on the first body pulls the second one down.
  builder.dynamics("v1", a * closed[0] - g * moves);
  builder.dynamics("v2", a * closed[1] - pull * a * closed[0] - g * moves);
  builder.dynamics("clock", moves);
  return Compiled(builder, Form::stewart);
}

TEST(Transition, TwoContactsAtRestAreHeldFromTheStart) {
  const Compiled model = two_contacts(0.0);
  ElementSolver solver(model.kernel, tableau(TableauFamily::radau_iia, 3));
  Transition transition(model.kernel, model.facts.parts, solver);
  const std::vector<double> x{0.0, 0.0, 0.0, 0.0, 0.0};
  const auto found = transition.continuations({0.0, x, nullptr, nullptr, {}, 1.0, 1e-3});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_TRUE(found[0].determined);
  std::vector<double> rates(5);
  model.kernel.field(0.0, x.data(), found[0].selections.data(), nullptr, rates.data());
  for (const int k : {0, 1, 2, 3}) EXPECT_NEAR(rates[at(k)], 0.0, 1e-12);
  EXPECT_GT(rates[4], 0.5);
  EXPECT_GE(*std::min_element(found[0].selections.begin(), found[0].selections.end()), -1e-12);
}

TEST(Transition, AContactThatIsHeldStaysClosedWhileAnotherOneStopsABody) {
  const Compiled model = two_contacts(0.5);
  const auto& surfaces = model.facts.parts.at(0).surfaces;
  ASSERT_EQ(surfaces, 4);
  // The first body comes down; the second one rests: its gap is closed, its rate held.
  Modes before(16, -1);
  const int comes_down = 0b0110, closes = 0b1110, holds = 0b0001;  // gap, rate, gap, rate: bits of negative sides
  before[comes_down] = before[comes_down | holds] = 0;
  const std::vector<double> x{0.0, -1.0, 0.0, 0.0, 0.0};
  ElementSolver solver(model.kernel, tableau(TableauFamily::radau_iia, 3));
  Transition transition(model.kernel, model.facts.parts, solver);
  const ActiveSet set = model.set(before);
  const std::vector<int> at_zero{comes_down, comes_down | holds, closes};
  const auto found = transition.continuations({0.0, x, nullptr, &set, at_zero, 1.0, 1e-3, closes});
  ASSERT_FALSE(found.empty());
  Modes after(16, -1);
  after[closes] = after[closes | holds] = 0;
  EXPECT_EQ(found[0].set.modes(), after);
  EXPECT_NEAR(found[0].selections[closes | holds], 0.5, 1e-12);
}

TEST(Transition, SurfacesWithoutInfluenceAreDecidedOneByOne) {
  model::Builder builder("two");
  const SX x = builder.state("x", {0.0});
  const SX y = builder.state("y", {0.0});
  builder.dynamics("x", 2.0 - builder.sign(x));
  builder.dynamics("y", 0.2 - builder.sign(y));
  const Compiled model(builder);
  const auto found = continuations(model, 0.0, {0.0, 0.0}, Modes{-1, -1}, {0, 1});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].set.modes(), (Modes{1, 0}));
  EXPECT_NEAR(found[0].selections[1], 0.6, 1e-12);
}

TEST(HeldValues, ChangeAtTheZerosOfTheirArguments) {
  model::Builder builder("held");
  const SX x = builder.state("x", {0.0});
  const SX t = builder.time();
  builder.dynamics("x", builder.step(t * t - 0.09) - x);
  const Compiled model(builder);
  ASSERT_EQ(model.facts.held.size(), 1U);
  HeldValues held(model.functions, model.facts.held);
  const double state = 0.0;
  static_cast<void>(held.set_behind(0.0, 1.0, &state));
  EXPECT_EQ(held.data()[0], 0.0);
  EXPECT_NEAR(held.next_change(0.0, 1.0, &state), 0.3, 1e-15);
  EXPECT_EQ(held.next_changing(), 0U);
  EXPECT_EQ(held.next_change(0.0, 0.25, &state), 0.25);
  EXPECT_EQ(held.next_changing(), std::nullopt);
  EXPECT_EQ(held.set_behind(0.3, 1.0, &state), HeldValues::Change::some);
  EXPECT_EQ(held.data()[0], 1.0);
  EXPECT_EQ(held.next_change(0.3, 1.0, &state), 1.0);
  EXPECT_EQ(held.set_behind(1.0, 1.0, &state), HeldValues::Change::none);
}

TEST(HeldValues, CellsOfFloorFollowEachOther) {
  model::Builder builder("cells");
  const SX x = builder.state("x", {0.0});
  builder.dynamics("x", builder.floor(2.0 * builder.time()) - x);
  const Compiled model(builder);
  HeldValues held(model.functions, model.facts.held);
  const double state = 0.0;
  double t = 0.0;
  static_cast<void>(held.set_behind(t, 1.0, &state));
  for (const double expected : {0.5, 1.0, 1.5}) {
    t = held.next_change(t, 10.0, &state);
    EXPECT_NEAR(t, expected, 1e-14);
    EXPECT_EQ(held.set_behind(t, 1.0, &state), HeldValues::Change::some);
    double rate = 0.0;
    model.kernel.field(t, &state, nullptr, held.data(), &rate);
    EXPECT_EQ(rate, 2.0 * expected);
  }
}

/// One listed surface x = 0 and a kink y = 0.
Compiled listed_and_kink() {
  model::Builder builder("recorded");
  const SX x = builder.state("x", {0.0});
  const SX y = builder.state("y", {0.0});
  builder.dynamics("x", -builder.sign(x, "stick"));
  builder.dynamics("y", builder.abs(y) + 1.0);
  return Compiled(builder);
}

TEST(Recorder, ASwitchIsTwoRowsAndAnEvent) {
  const Compiled model = listed_and_kink();
  Recorder recorder(model.functions, model.facts);
  const ActiveSet before = model.set({-1, 1}), behind = model.set({0, 1}), other = model.set({1, 1});
  const std::vector<double> from{0.0, 1.0}, to{0.5, 1.0}, also{1.0, 1.0};
  EXPECT_TRUE(
      recorder.switched(2.0, {0.0, 3.0}, {&before, &from, nullptr}, {{behind, to}, {other, also}}, nullptr, "because"));
  const auto& rows = recorder.trajectory();
  EXPECT_EQ(rows.t, (std::vector{2.0, 2.0}));
  ASSERT_EQ(recorder.event_list().size(), 1U);
  const result::Event& event = recorder.event_list()[0];
  EXPECT_EQ(event.kind, result::EventKind::enter_sliding);
  EXPECT_EQ(event.surfaces, std::vector<std::string>{"stick"});
  EXPECT_EQ(event.mode_before->front(), -1);
  EXPECT_EQ(event.mode_after->front(), 0);
  EXPECT_EQ(event.alpha_after->front(), 0.5);
  EXPECT_EQ(event.unique, false);
  ASSERT_EQ(event.alternatives.size(), 1U);
  EXPECT_EQ(event.alternatives[0].mode.front(), 1);
  EXPECT_EQ(event.reason, "because");
}

TEST(Recorder, AKinkIsNoEvent) {
  const Compiled model = listed_and_kink();
  Recorder recorder(model.functions, model.facts);
  const ActiveSet before = model.set({1, -1}), behind = model.set({1, 1});
  const std::vector<double> from{1.0, 0.0}, to{1.0, 1.0};
  EXPECT_FALSE(recorder.switched(2.0, {1.0, 0.0}, {&before, &from, nullptr}, {{behind, to}}, nullptr, "because"));
  EXPECT_TRUE(recorder.event_list().empty());
}

TEST(Recorder, NestedFunctionsHaveTheSelectionOfTheirBranch) {
  // step(x + sign(y)): two surfaces x + 1 and x - 1 inside, one column.
  model::Builder builder("nested");
  const SX x = builder.state("x", {0.0});
  const SX y = builder.state("y", {0.0});
  builder.dynamics("x", 1.0 - 2.0 * builder.step(x + builder.sign(y, "inner"), "outer"));
  builder.dynamics("y", SX(1.0));
  const Compiled model(builder);
  ASSERT_EQ(model.kernel.selections(), 3U);
  Recorder recorder(model.functions, model.facts);
  const std::size_t inner = model.facts.columns[0].name == "inner" ? 0 : 1;
  for (const int side : {-1, 1}) {
    // x = 0: x + 1 > 0 > x - 1.
    Modes modes(3);
    std::vector<double> selections(3);
    std::vector<double> indicators(3);
    const std::vector<double> state{0.0, static_cast<double>(side)};
    model.kernel.indicators(0.0, state.data(), nullptr, indicators.data());
    for (std::size_t j = 0; j < 3; ++j) {
      modes[j] = indicators[j] > 0.0 ? 1 : -1;
      selections[j] = indicators[j] > 0.0 ? 1.0 : 0.0;
    }
    const auto view = recorder.view(model.set(modes), selections, nullptr);
    EXPECT_EQ(view.mode[static_cast<std::size_t>(model.facts.columns[inner].function)], side);
    EXPECT_EQ(view.mode[static_cast<std::size_t>(model.facts.columns[1 - inner].function)], side);
    EXPECT_EQ(view.alpha[static_cast<std::size_t>(model.facts.columns[1 - inner].function)], side > 0 ? 1.0 : 0.0);
  }
}

}  // namespace
}  // namespace saltus::fesd_integrator
