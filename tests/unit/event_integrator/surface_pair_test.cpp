// The fast path of the usual meeting of two surfaces against the full decision.
#include "saltus/event_integrator/decide/fast/surface_pair.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <random>

#include <gtest/gtest.h>

#include "same_transition.hpp"
#include "systems.hpp"

namespace saltus::event_integrator {
namespace {

using casadi::SX;

const std::vector<double> origin(4, 0.0);

/// Four affine fields that meet where two affine surfaces intersect, in four dimensions, all coefficients random.
model::System random_meeting(std::mt19937& random) {
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  auto s = testing::blank(4, 2);
  const auto affine = [&](double offset) {
    SX sum = offset + number(random) * s.t;
    for (int i = 0; i < 4; ++i) sum += number(random) * s.x(i);
    return sum;
  };
  testing::add_surface(s, "first", affine(0.0));
  testing::add_surface(s, "second", affine(0.0));
  const SX a = s.alpha(0);
  const SX b = s.alpha(1);
  std::vector<SX> f;
  for (int i = 0; i < 4; ++i) {
    std::array<SX, 4> corners;
    for (auto& corner : corners) corner = affine(number(random));
    f.push_back((1 - a) * (1 - b) * corners[0] + a * (1 - b) * corners[1] + (1 - a) * b * corners[2] +
                a * b * corners[3]);
  }
  testing::set_field(s, f, origin);
  return s;
}

SwitchingPoint meeting_from(const ModeState& before) {
  SwitchingPoint switching_point;
  switching_point.x = origin.data();
  switching_point.at_zero = {0, 1};
  for (const int j : {0, 1}) {
    if (before.mode[static_cast<std::size_t>(j)] != 0) switching_point.touched.push_back(j);
  }
  switching_point.time_scale = 0.1;
  return switching_point;
}

ModeState state_of(std::array<int, 2> mode) {
  ModeState state{{mode[0], mode[1]}, {}, {}, {}};
  for (const int j : {0, 1}) {
    const int k = state.mode[static_cast<std::size_t>(j)];
    state.alpha.push_back(k > 0 ? 1.0 : k < 0 ? 0.0 : 0.4);
    if (k == 0) state.sliding.push_back(j);
  }
  set_corner_alpha(state);
  return state;
}

TEST(SurfacePair, DecidesLikeTheGeneralDecision) {
  std::mt19937 random(20240711);
  int entered = 0, crossed = 0, left = 0, both = 0, other = 0;
  for (int k = 0; k < 100; ++k) {
    const auto system = random_meeting(random);
    auto kernel = evaluation::ModelKernel::compile(system);
    ASSERT_TRUE(kernel.has_value());
    const SwitchingContext switching_context{*kernel, true, {}, {}};
    SurfacePair pair(switching_context);
    Transition transition;
    for (const std::array<int, 2> mode : {std::array{0, -1}, {0, 1}, {-1, 0}, {1, 0}, {-1, -1}, {1, 1}}) {
      const ModeState before = state_of(mode);
      const auto switching_point = meeting_from(before);
      if (!pair.decide(before, switching_point, transition)) {
        ++other;
        continue;
      }
      expect_same(transition, decide_mode(switching_context, before, switching_point));
      const auto slides = transition.state.sliding.size();
      ++(slides == 2 ? entered : slides == 0 ? left : crossed);
      both += before.sliding.empty() ? 1 : 0;
    }
  }
  // Each way of going on, and from regions as well; most random tables do not bring the solution to the intersection.
  EXPECT_GT(entered, 10);
  EXPECT_GT(crossed, 10);
  EXPECT_GT(left, 10);
  EXPECT_GT(both, 5);
  EXPECT_GT(other, 100);
}

TEST(SurfacePair, SlidesAcrossWithTheSelectionsOfTheGeneralDecision) {
  std::mt19937 random(20261123);
  int crossed = 0, other = 0;
  std::vector<double> slope(origin.size());
  for (int k = 0; k < 800; ++k) {
    const auto system = random_meeting(random);
    auto kernel = evaluation::ModelKernel::compile(system);
    ASSERT_TRUE(kernel.has_value());
    const SwitchingContext switching_context{*kernel, true, {}, {}};
    SurfacePair pair(switching_context);
    ModeField field(*kernel, true);
    for (const std::array<int, 2> mode : {std::array{0, -1}, {0, 1}, {-1, 0}, {1, 0}}) {
      const ModeState before = state_of(mode);
      const auto switching_point = meeting_from(before);
      field.enter(before);
      field(switching_point.t, switching_point.x, slope.data());
      std::optional<SlidAcross> across;
      if (pair.look(before, switching_point, &field)) across = pair.across(before, switching_point);
      const Transition general = decide_mode(switching_context, before, switching_point);
      if (!across) {
        ++other;
        continue;
      }
      ++crossed;
      EXPECT_EQ(general.termination, result::Termination::completed);
      EXPECT_EQ(general.unique, true);
      EXPECT_EQ(general.state.mode, (std::vector<int>{-mode[0], -mode[1]}));
      EXPECT_EQ(across->surface, mode[0] == 0 ? 0 : 1);
      EXPECT_EQ(across->alpha_before, 0.4);
      EXPECT_EQ(general.state.alpha[static_cast<std::size_t>(across->surface)], across->alpha_after);
      ASSERT_TRUE(general.meeting.has_value());
      const Meeting& meeting = across->meeting;
      EXPECT_EQ(meeting.surfaces, general.meeting->surfaces);
      EXPECT_EQ(meeting.velocities, general.meeting->velocities);
      EXPECT_EQ(meeting.alpha, general.meeting->alpha);
    }
  }
  // Few random tables lead across in all four regions.
  EXPECT_GT(crossed, 10);
  EXPECT_GT(other, 100);
}

TEST(SurfacePair, LeavesWhatIsNotSimpleToTheGeneralDecision) {
  std::mt19937 random(20240712);
  const auto decides = [&](auto&& change) {
    std::mt19937 same = random;
    int decided = 0;
    for (int k = 0; k < 20; ++k) {
      const auto system = random_meeting(same);
      auto kernel = evaluation::ModelKernel::compile(system);
      const SwitchingContext switching_context{*kernel, true, {}, {}};
      SurfacePair pair(switching_context);
      Transition transition;
      const ModeState before = state_of({0, -1});
      auto switching_point = meeting_from(before);
      change(switching_point);
      decided += pair.decide(before, switching_point, transition) ? 1 : 0;
    }
    return decided;
  };
  EXPECT_GT(decides([](SwitchingPoint&) {}), 0);
  EXPECT_EQ(decides([](SwitchingPoint& switching_point) { switching_point.start = true; }), 0);
  EXPECT_EQ(decides([](SwitchingPoint& switching_point) { switching_point.exit_above = {0}; }), 0)
      << "a selection is at its bound";
  EXPECT_EQ(decides([](SwitchingPoint& switching_point) {
              switching_point.touched = {0, 1};
            }),
            0)
      << "the surface slid on has a kink";
  EXPECT_EQ(decides([](SwitchingPoint& switching_point) { switching_point.at_zero = {1}; }), 0) << "one surface";
}

}  // namespace
}  // namespace saltus::event_integrator
