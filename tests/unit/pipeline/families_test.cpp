// Families of other solutions: when they may leave, and that their members are the solutions that closed forms say.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "saltus/model/builder.hpp"
#include "saltus/pipeline/simulate.hpp"

namespace saltus::pipeline {
namespace {

using casadi::SX;
using model::Builder;
using result::Family;
using result::FamilyKind;
using result::Mode;
using result::Result;

struct Span {
  double from = 0.0;
  double until = 1.0;
};

Result run(Builder& builder, Span span, long members) {
  const auto system = builder.build();
  EXPECT_TRUE(system.has_value()) << (system ? "" : system.error().message);
  SimulateOptions options;
  options.from = span.from;
  options.until = span.until;
  options.event.trajectories = 64;
  options.event.members = members;
  options.native = Native::off;
  options.initial_mode = {};
  const auto result = simulate(*system, options);
  EXPECT_TRUE(result.has_value()) << (result ? "" : result.error().message);
  return *result;
}

/// The trajectory of a tree that begins in a mode; the root counts.
const Result* starting_in(const Result& root, const Mode& mode) {
  if (root.trajectory.mode[1] == mode) return &root;
  for (const Result& branch : root.branches) {
    if (branch.events[0].mode_after == mode) return &branch;
  }
  ADD_FAILURE() << "no such trajectory";
  return &root;
}

const Family* family_to(const Result& result, const Mode& mode) {
  for (const Family& family : result.families) {
    if (family.to.mode == mode) return &family;
  }
  return nullptr;
}

/// Branches that are members of the family to this mode.
std::vector<const Result*> members_of(const Result& result, const Mode& mode) {
  std::vector<const Result*> members;
  for (const Result& branch : result.branches) {
    if (branch.left_at->member && result.families[branch.left_at->member->family].to.mode == mode) {
      members.push_back(&branch);
    }
  }
  return members;
}

void expect_end(const Result& result, const std::vector<double>& x) {
  EXPECT_EQ(result.status.termination, result::Termination::completed) << result.status.message;
  ASSERT_EQ(result.final.x.size(), x.size());
  for (std::size_t i = 0; i < x.size(); ++i) EXPECT_NEAR(result.final.x[i], x[i], 1e-11) << i;
}

/// x' = f_below(t) where x < 0, f_above where x > 0; from 0.
void on_a_line(const SX& below, const SX& above, Builder& b) {
  const SX x = b.state("x", {0});
  const SX alpha = b.step(x);
  b.dynamics("x", below + alpha * (above - below));
}

TEST(Families, OfARepellingSurfaceLeaveToEitherSideAtAnyTime) {
  Builder b("spontaneous");
  on_a_line(-1, 1, b);
  const Result root = run(b, {0, 2}, 3);
  EXPECT_TRUE(root.families.empty());
  const Result& staying = *starting_in(root, {0});
  expect_end(staying, {0});
  ASSERT_EQ(staying.families.size(), 2U);
  for (const int side : {-1, 1}) {
    const Family* family = family_to(staying, {side});
    ASSERT_NE(family, nullptr);
    EXPECT_EQ(family->kind, FamilyKind::later_departure);
    EXPECT_EQ(family->event, 0U);
    EXPECT_EQ(family->from, 0.0);
    EXPECT_EQ(family->until, 2.0);
    const auto members = members_of(staying, {side});
    ASSERT_EQ(members.size(), 3U);
    for (std::size_t i = 0; i < 3; ++i) {
      const double t = 0.5 * static_cast<double>(i + 1);
      const Result& member = *members[i];
      EXPECT_EQ(member.left_at->member->parameter, t);
      expect_end(member, {side * (2 - t)});
      ASSERT_EQ(member.events.size(), 1U);
      EXPECT_EQ(member.events[0].t, t);
      EXPECT_EQ(member.events[0].kind, result::EventKind::leave_sliding);
      EXPECT_EQ(member.events[0].unique, false);
      ASSERT_EQ(member.events[0].alternatives.size(), 2U);
      EXPECT_EQ(member.events[0].alternatives[0].mode, Mode{0});
      EXPECT_EQ(member.events[0].alternatives[1].mode, Mode{-side});
      EXPECT_EQ(member.trajectory.t.front(), t);
      EXPECT_EQ(member.trajectory.t[1], t);
      EXPECT_TRUE(member.branches.empty());
    }
  }
  EXPECT_EQ(result::not_followed(root), 0U);
  EXPECT_EQ(result::not_followed(staying), 0U);
}

TEST(Families, AreListedWithoutBeingFollowed) {
  Builder b("spontaneous");
  on_a_line(-1, 1, b);
  const Result root = run(b, {0, 2}, 0);
  const Result& staying = *starting_in(root, {0});
  EXPECT_EQ(staying.families.size(), 2U);
  EXPECT_TRUE(staying.branches.empty());
}

TEST(Families, EndWithTheModeThatTheyLeave) {
  // From t = 1 on the field below points up, too: nothing can stay.
  Builder b("turning");
  on_a_line(b.time() - 1, 2, b);
  const Result root = run(b, {0, 2}, 1);
  const Result& staying = *starting_in(root, {0});
  ASSERT_EQ(staying.events.size(), 2U);
  EXPECT_NEAR(staying.events[1].t, 1.0, 1e-12);
  expect_end(staying, {2});
  ASSERT_EQ(staying.families.size(), 2U);
  for (const Family& family : staying.families) {
    EXPECT_EQ(family.from, 0.0);
    EXPECT_NEAR(family.until, 1.0, 1e-12);
  }
  const auto up = members_of(staying, {1}), down = members_of(staying, {-1});
  ASSERT_EQ(up.size(), 1U);
  ASSERT_EQ(down.size(), 1U);
  expect_end(*up[0], {3});
  // ((t - 1)^2 - 1/4)/2 is back at 3/2, and goes on upwards.
  ASSERT_EQ(down[0]->events.size(), 2U);
  EXPECT_NEAR(down[0]->events[1].t, 1.5, 1e-10);
  expect_end(*down[0], {1});
}

/// Leaf C9-4 (the model part-ways); at t = 1 no scaling keeps the solution on both surfaces any more. Returns sign(x).
SX part_ways(Builder& b) {
  const SX x = b.state("x", {0}), y = b.state("y", {0});
  const SX s1 = b.sign(x), s2 = b.sign(y);
  b.dynamics("x", (b.time() - 1) / 4 * s1 + s2 + s1 * s2 / 2);
  b.dynamics("y", -s1 / 2 + s2 + s1 * s2 / 5);
  return s1;
}

TEST(Families, OfTwoSurfacesBeginAndEndWhereAModeIsAdmissible) {
  Builder b("part-ways");
  part_ways(b);
  constexpr double begin = -0.75, end = 3.0;
  const Result root = run(b, {begin, end}, 1);
  const Result& staying = *starting_in(root, {0, 0});
  // Along y = 0 to x < 0 from t = -1/4 on, where -5/16 - (t - 1)/4 becomes negative; the others from the start.
  struct Expected {
    Mode mode;
    double from;
  };
  for (const auto& [mode, from] :
       {Expected{{1, 1}, begin}, Expected{{-1, -1}, begin}, Expected{{1, 0}, begin}, Expected{{-1, 0}, -0.25}}) {
    const Family* family = family_to(staying, mode);
    ASSERT_NE(family, nullptr) << mode[0] << mode[1];
    EXPECT_NEAR(family->from, from, 1e-9);
    EXPECT_NEAR(family->until, 1.0, 1e-12);
    const auto members = members_of(staying, mode);
    ASSERT_EQ(members.size(), 1U);
    const double t = 0.5 * (family->from + family->until);
    EXPECT_NEAR(members[0]->left_at->member->parameter, t, 1e-15);
    EXPECT_EQ(members[0]->events[0].mode_after, mode);
    const double drift = (std::pow(end - 1, 2) - std::pow(t - 1, 2)) / 8, time = end - t;
    if (mode == Mode{1, 1}) expect_end(*members[0], {drift + 1.5 * time, 0.7 * time});
    if (mode == Mode{-1, -1}) expect_end(*members[0], {-drift - 0.5 * time, -0.3 * time});
    if (mode == Mode{1, 0}) expect_end(*members[0], {drift + 0.625 * time, 0});
    if (mode == Mode{-1, 0}) expect_end(*members[0], {-drift - 0.3125 * time, 0});
  }
  // The other root, lambda_1 = -(t + 1)/(1 + (t - 1)/5), reaches the edge of the square when that motion begins.
  const Family* other_root = family_to(staying, {0, 0});
  ASSERT_NE(other_root, nullptr);
  EXPECT_EQ(other_root->from, begin);
  EXPECT_NEAR(other_root->until, -0.25, 1e-9);
  EXPECT_NEAR(other_root->to.alpha[0], 0.5 * (1 - 0.25 / 0.65), 1e-12);
  EXPECT_EQ(staying.families.size(), 5U);
  // Its members change to it, and leave where it ends, to one of two sides.
  const auto members = members_of(staying, {0, 0});
  ASSERT_EQ(members.size(), 1U);
  const Result& member = *members[0];
  EXPECT_NEAR(member.left_at->member->parameter, 0.5 * (begin - 0.25), 1e-9);
  ASSERT_EQ(member.events.size(), 2U);
  EXPECT_EQ(member.events[0].kind, result::EventKind::start);
  EXPECT_EQ(member.events[0].mode_after, (Mode{0, 0}));
  EXPECT_NEAR(member.events[1].t, -0.25, 1e-9);
  EXPECT_EQ(member.events[1].mode_after, (Mode{-1, -1}));
  const double time = end + 0.25;
  expect_end(member, {-(std::pow(end - 1, 2) - std::pow(1.25, 2)) / 8 - 0.5 * time, -0.3 * time});
  // What it may be left into: the first root is the other one now.
  const Family* first_root = family_to(member, {0, 0});
  ASSERT_NE(first_root, nullptr);
  EXPECT_EQ(first_root->from, member.left_at->member->parameter);
  EXPECT_NEAR(first_root->until, -0.25, 1e-9);
  EXPECT_GT(std::abs(first_root->to.alpha[0] - other_root->to.alpha[0]), 1e-3);
}

// The same with a third surface that is slid on whatever the other two do, with sign(z) = sign(x)/4.
TEST(Families, OfThreeSurfacesBeginAndEndWhereAModeIsAdmissible) {
  Builder b("part-ways");
  const SX side = part_ways(b);
  const SX z = b.state("z", {0});
  b.dynamics("z", side / 4 - b.sign(z));
  constexpr double begin = -0.75, end = 3.0;
  const Result root = run(b, {begin, end}, 1);
  // Of the two roots the one with x' = 0 and y' = 0 for sign(x) = sign(y) = 0.
  const Result* found = nullptr;
  for (const Result& branch : root.branches) {
    const auto alpha = branch.events[0].alpha_after;
    if (branch.events[0].mode_after == Mode{0, 0, 0} && alpha && std::abs((*alpha)[0] - 0.5) < 1e-6) found = &branch;
  }
  if (root.trajectory.mode[1] == Mode{0, 0, 0}) found = &root;
  ASSERT_NE(found, nullptr);
  const Result& staying = *found;
  struct Expected {
    Mode mode;
    double from;
  };
  for (const auto& [mode, from] : {Expected{{1, 1, 0}, begin}, Expected{{-1, -1, 0}, begin}, Expected{{1, 0, 0}, begin},
                                   Expected{{-1, 0, 0}, -0.25}}) {
    const Family* family = family_to(staying, mode);
    ASSERT_NE(family, nullptr) << mode[0] << mode[1];
    EXPECT_NEAR(family->from, from, 1e-9);
    EXPECT_NEAR(family->until, 1.0, 1e-12);
    const auto members = members_of(staying, mode);
    ASSERT_EQ(members.size(), 1U);
    const double t = 0.5 * (family->from + family->until);
    EXPECT_NEAR(members[0]->left_at->member->parameter, t, 1e-15);
    EXPECT_EQ(members[0]->events[0].mode_after, mode);
    const double drift = (std::pow(end - 1, 2) - std::pow(t - 1, 2)) / 8, time = end - t;
    if (mode == Mode{1, 1, 0}) expect_end(*members[0], {drift + 1.5 * time, 0.7 * time, 0});
    if (mode == Mode{-1, -1, 0}) expect_end(*members[0], {-drift - 0.5 * time, -0.3 * time, 0});
    if (mode == Mode{1, 0, 0}) expect_end(*members[0], {drift + 0.625 * time, 0, 0});
    if (mode == Mode{-1, 0, 0}) expect_end(*members[0], {-drift - 0.3125 * time, 0, 0});
  }
  const Family* other_root = family_to(staying, {0, 0, 0});
  ASSERT_NE(other_root, nullptr);
  EXPECT_EQ(other_root->from, begin);
  EXPECT_NEAR(other_root->until, -0.25, 1e-9);
  EXPECT_NEAR(other_root->to.alpha[0], 0.5 * (1 - 0.25 / 0.65), 1e-12);
  EXPECT_NEAR(other_root->to.alpha[2], 0.5 * (1 - 0.25 / 0.65 / 4), 1e-12);
  EXPECT_EQ(staying.families.size(), 5U);
}

TEST(Families, OfASpiralHaveAllPhases) {
  // Filippov's spiral backwards: it meets the axes at distance 2 t, three times as late each quarter turn.
  Builder b("outwards");
  const SX x = b.state("x", {0}), y = b.state("y", {0});
  const SX s1 = b.sign(x), s2 = b.sign(y);
  b.dynamics("x", s1 - 2 * s2);
  b.dynamics("y", 2 * s1 + s2);
  const Result root = run(b, {0, 1}, 3);
  ASSERT_FALSE(root.families.empty());
  const Family& family = root.families.front();
  EXPECT_EQ(family.kind, FamilyKind::spiral);
  EXPECT_EQ(family.from, 0.0);
  EXPECT_EQ(family.until, 0.0);
  ASSERT_TRUE(family.lap_ratio.has_value());
  EXPECT_NEAR(*family.lap_ratio, 81.0, 1e-12);
  int members = 0;
  for (const Result& branch : root.branches) {
    if (!branch.left_at->member) continue;
    ++members;
    const double phase = branch.left_at->member->parameter;
    EXPECT_EQ(phase, members / 4.0);
    const auto& own = branch.events.back();
    EXPECT_NEAR(std::hypot(own.x[0], own.x[1]), 2 * own.t, 1e-9);
    const std::vector<result::Event> events = root.events;
    const auto other = std::find_if(events.rbegin(), events.rend(),
                                    [&](const auto& event) { return event.mode_after == own.mode_after; });
    ASSERT_NE(other, events.rend());
    const double cycles = std::log(own.t / other->t) / std::log(81.0) - phase;
    EXPECT_NEAR(cycles, std::round(cycles), 1e-9);
  }
  EXPECT_EQ(members, 3);
}

TEST(Families, AreNoneWhereTheSolutionIsUnique) {
  Builder b("attracting");
  const SX x = b.state("x", {0}), y = b.state("y", {0});
  const SX s1 = b.sign(x), s2 = b.sign(y);
  b.dynamics("x", -s1 + s2 / 4);
  b.dynamics("y", -s2 - s1 / 4);
  const Result root = run(b, {0, 1}, 2);
  EXPECT_EQ(root.final.mode, (Mode{0, 0}));
  EXPECT_TRUE(root.families.empty());
  EXPECT_TRUE(root.branches.empty());
}

}  // namespace
}  // namespace saltus::pipeline
