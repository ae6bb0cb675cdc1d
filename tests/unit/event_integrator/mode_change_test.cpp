// A change of one surface, and the same change told as one of the whole mode: every part begins the same mode.
#include "saltus/event_integrator/mode/mode_change.hpp"

#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "saltus/event_integrator/accumulate/switch_series.hpp"
#include "saltus/event_integrator/field/field_memory.hpp"
#include "saltus/event_integrator/record/recorder.hpp"
#include "saltus/event_integrator/search/event_search.hpp"
#include "saltus/event_integrator/steps/step_memory.hpp"
#include "systems.hpp"

namespace saltus::event_integrator {
namespace {

/// Two surfaces that influence each other: both fields of each point to it, whatever the other one is.
model::System two_surfaces() {
  auto s = testing::blank(3, 2);
  const auto sign = [&](int j) { return 2 * s.alpha(j) - 1; };
  testing::add_surface(s, "first", s.x(0));
  testing::add_surface(s, "second", s.x(1) + 0.5 * s.x(0));
  testing::set_field(s, {0.1 * s.x(2) - sign(0) - 0.2 * sign(1), 0.3 - 2 * sign(1) + 0.1 * s.x(0), s.x(1)}, {0, 0, 1});
  return s;
}

ModeState mode_of(std::array<int, 2> mode, std::array<double, 2> alpha) {
  ModeState state{{mode[0], mode[1]}, {alpha[0], alpha[1]}, {}, {}};
  for (const int j : {0, 1}) {
    if (mode[static_cast<std::size_t>(j)] == 0) state.sliding.push_back(j);
  }
  set_corner_alpha(state);
  return state;
}

/// A mode, and what changes behind it.
struct Case {
  ModeState before;
  ModeChange change;
  SlidAcross slid = {};
};

/// Entering, leaving, crossing, and sliding across.
std::array<Case, 4> cases() {
  return {Case{mode_of({-1, -1}, {0.0, 0.0}), {.surface = 1, .before = -1, .after = 0, .alpha_after = 0.65}},
          Case{mode_of({0, -1}, {0.4, 0.0}), {.surface = 0, .after = 1, .alpha_before = 0.4, .alpha_after = 1.0}},
          Case{mode_of({-1, 1}, {0.0, 1.0}), {.surface = 0, .before = -1, .after = 1, .alpha_after = 1.0}},
          Case{mode_of({0, -1}, {0.6, 0.0}),
               {.surface = 1, .before = -1, .after = 1, .alpha_after = 1.0},
               {.surface = 0, .alpha_before = 0.6, .alpha_after = 0.4}}};
}

/// Everything that begins with a mode, in the mode before.
struct Parts {
  Parts(evaluation::ModelKernel& kernel, const ModeState& before)
      : field(kernel, true),
        here(1.0, {0.0, 0.0, 1.0}),
        ledger(kernel),
        search(kernel, field, ledger, ode::Method::dopri5, tolerances),
        recorder(kernel) {
    here.change_mode(before);
    field.enter(before);
    field(here.t, here.x.data(), here.slope.data());
    search.enter(before, {0, 0}, 0.0, here.x.data());
    recorder.row(here.t, here.x, before, before.alpha);
    EXPECT_EQ(memory.change(before.mode, 0.0, 0.1), 0.1);
  }

  void begin(const ModeChange& change) {
    field.begin(change);
    EXPECT_TRUE(recorder.switched(here.t, here.x, change));
    here.change_mode(change);
    field(here.t, here.x.data(), here.slope.data());
    search.begin(change, here);
    recorder.row_behind(here.x, here.state, here.state.sliding.empty() ? here.state.alpha : field.alpha(), change);
    here.h = memory.change(here.state.mode, here.t, 0.2, change);
    EXPECT_FALSE(series.note(here.t, change));
  }

  ode::Tolerances tolerances{1e-6, 1e-8};
  ModeField field;
  Position here;
  Ledger ledger;
  EventSearch search;
  Recorder recorder;
  StepMemory memory;
  SwitchSeries series{10.0};
};

TEST(ModeChange, MakesTheModeBehind) {
  for (auto& [before, change, slid] : cases()) {
    ModeChange one = change;
    if (slid.surface >= 0) one.slid = &slid;
    ModeState state = before;
    apply(one, state);
    ModeState expected = mode_of({state.mode[0], state.mode[1]}, {state.alpha[0], state.alpha[1]});
    EXPECT_EQ(state.mode[static_cast<std::size_t>(change.surface)], change.after);
    EXPECT_EQ(state.alpha[static_cast<std::size_t>(change.surface)], change.alpha_after);
    EXPECT_EQ(state.sliding, expected.sliding);
    if (!state.sliding.empty()) {
      EXPECT_EQ(state.corner_alpha, expected.corner_alpha);
    }
    if (slid.surface >= 0) {
      EXPECT_EQ(state.alpha[static_cast<std::size_t>(slid.surface)], slid.alpha_after);
    }
  }
}

TEST(ModeChange, EveryPartBeginsTheSameModeFromOneSurfaceAsFromAllOfIt) {
  const auto system = two_surfaces();
  auto kernel = evaluation::ModelKernel::compile(system);
  ASSERT_TRUE(kernel.has_value());
  for (auto& [before, told, slid] : cases()) {
    SCOPED_TRACE(::testing::Message() << "surface " << told.surface << " from " << told.before << " to " << told.after);
    FieldMemory regions(*kernel);
    ModeChange change = told;
    if (slid.surface >= 0) change.slid = &slid;
    for (std::size_t side = 0; told.before != 0 && side < 2; ++side) {
      std::vector<double> alpha = before.alpha;
      alpha[static_cast<std::size_t>(told.surface)] = told.before < 0 ? 1.0 : 0.0;
      if (slid.surface >= 0) alpha[static_cast<std::size_t>(slid.surface)] = static_cast<double>(side);
      change.beyond[side] = &regions.of(alpha, side);
    }
    Transition transition;
    transition.state = before;
    apply(change, transition.state);
    transition.zero_order.assign(2, 0);
    transition.zero_order[static_cast<std::size_t>(told.surface)] = change.order();

    Parts one(*kernel, before), all(*kernel, before);
    one.begin(change);
    all.begin(transition.from(before));

    EXPECT_EQ(one.here.state.mode, all.here.state.mode);
    EXPECT_EQ(one.here.slope, all.here.slope);
    EXPECT_EQ(one.field.alpha(), all.field.alpha());
    EXPECT_EQ(one.field.solve(), all.field.solve());
    EXPECT_EQ(one.here.h, all.here.h);
    const auto& functions = one.search.functions();
    ASSERT_EQ(functions.size(), all.search.functions().size());
    for (std::size_t i = 0; i < functions.size(); ++i) {
      const auto& other = all.search.functions()[i];
      EXPECT_EQ(functions[i].kind, other.kind) << i;
      if (other.kind == FunctionKind::absent) continue;
      EXPECT_EQ(functions[i].index, other.index) << i;
      EXPECT_EQ(functions[i].sign, other.sign) << i;
      EXPECT_EQ(functions[i].zero_order, other.zero_order) << i;
      EXPECT_EQ(functions[i].offset, other.offset) << i;
    }
    // The way back at the same time, twice.
    Transition back = transition;
    back.state = before;
    for (auto* parts : {&one, &all}) {
      EXPECT_FALSE(parts->series.note(1.0, back.from(transition.state)));
      EXPECT_TRUE(parts->series.note(1.0, transition.from(before))) << "it was noted before";
    }
    const auto a = one.recorder.take(), b = all.recorder.take();
    ASSERT_EQ(a.event_list.size(), 1U);
    EXPECT_EQ(a.event_list[0].kind, b.event_list[0].kind);
    EXPECT_EQ(a.event_list[0].mode, b.event_list[0].mode);
    EXPECT_EQ(a.event_list[0].mode_after, b.event_list[0].mode_after);
    EXPECT_EQ(a.surfaces, b.surfaces);
    EXPECT_EQ(a.row_modes, b.row_modes);
  }
}

TEST(ModeChange, ConstantsOfARegionThatItDoesNotKnowAreMadeBeforeTheFieldSlides) {
  const auto system = two_surfaces();
  auto kernel = evaluation::ModelKernel::compile(system);
  ASSERT_TRUE(kernel.has_value());
  ModeField one(*kernel, true), all(*kernel, true);
  one.enter(mode_of({-1, 1}, {0.0, 1.0}));
  all.enter(mode_of({1, 1}, {1.0, 1.0}));
  one.begin({.surface = 0, .before = -1, .after = 1, .alpha_after = 1.0});
  const std::vector<double> x{0.1, -0.2, 0.3};
  std::array<double, 3> slope_of_one{}, slope_of_all{};
  one(0.0, x.data(), slope_of_one.data());
  all(0.0, x.data(), slope_of_all.data());
  EXPECT_EQ(slope_of_one, slope_of_all);
  EXPECT_TRUE(one.prepare());
  EXPECT_FALSE(one.prepare()) << "there are some now";
}

TEST(FieldMemory, KeepsItsLastAnswerBesideTheNextOne) {
  const auto system = two_surfaces();
  auto kernel = evaluation::ModelKernel::compile(system);
  ASSERT_TRUE(kernel.has_value());
  FieldMemory regions(*kernel);
  // One region again and again, and between that more others than it keeps.
  const std::vector<double> first{0.5, 0.0};
  for (int k = 0; k < 200; ++k) {
    const std::vector<double> second{static_cast<double>(k), 1.0};
    const auto& one = regions.of(first, 7);
    const auto& other = regions.of(second, static_cast<std::size_t>(1000 + k));
    EXPECT_EQ(one.alpha, first) << k;
    EXPECT_EQ(other.alpha, second) << k;
  }
}

}  // namespace
}  // namespace saltus::event_integrator
