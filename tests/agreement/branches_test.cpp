// Shipped models whose solutions are not unique, with --branch all: every motion is found, and ends where it should.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "problems/simulator.hpp"

namespace saltus::problems {
namespace {

using result::Result;
using result::Termination;

struct Branch {
  std::vector<int> mode;
  std::vector<double> x;
};

void expect_branches(const std::string& name, const std::vector<Branch>& branches) {
  const Simulator model = Simulator::from_catalogue(name);
  for (const Accuracy& accuracy : {fine, standard, implicit}) {
    auto options = with(model.options(), accuracy);
    options.event.trajectories = 64;
    const Result result = model.run(options);
    ASSERT_EQ(result.status.termination, Termination::completed) << name << ": " << result.status.message;
    ASSERT_EQ(result.branches.size(), branches.size()) << name;
    for (std::size_t b = 0; b < branches.size(); ++b) {
      const Result& branch = result.branches[b];
      EXPECT_EQ(branch.status.termination, Termination::completed) << name << ": " << branch.status.message;
      EXPECT_TRUE(branch.branches.empty()) << name;
      EXPECT_EQ(branch.final.mode, branches[b].mode) << name;
      ASSERT_EQ(branch.final.x.size(), branches[b].x.size());
      for (std::size_t i = 0; i < branches[b].x.size(); ++i) {
        // The fields are constant: only roundings are left.
        EXPECT_NEAR(branch.final.x[i], branches[b].x[i], 1e-11) << name << ", " << i;
      }
    }
  }
}

/// Where the two fields of a surface balance, if one says `below` and the other one `above`.
double balance(double below, double above) { return below / (below - above); }

double between(double below, double above, double alpha) { return below + alpha * (above - below); }

// Leaf E10. Along x = 0 to the intersection; then along y > 0 or x > 0 between fields that leave both, into x < 0 < y,
// or (what a regularised solution does as well as staying) into x, y > 0.
TEST(ShippedBranches, StayOrLeave) {
  const double left = 6.0 - 1.0 / between(0.609, -0.9416, balance(0.5223, -1.7734));
  expect_branches("stay-or-leave", {{{0, 1}, {0.0, between(0.3146, 0.115, balance(-0.194, 1.011)) * left}},
                                    {{1, 0}, {between(-1.7734, 1.011, balance(-0.9416, 0.115)) * left, 0.0}},
                                    {{-1, 1}, {-0.194 * left, 0.3146 * left}},
                                    {{1, 1}, {1.011 * left, 0.115 * left}}});
}

// Leaf E12: the other, unstable, motion on both surfaces, or along x = 0 into y > 0.
TEST(ShippedBranches, StayOrSlide) {
  const double left = 36.0 - 1.0 / between(0.3463, -0.904, balance(0.4168, -1.4013));
  expect_branches("stay-or-slide",
                  {{{0, 0}, {0.0, 0.0}}, {{0, 1}, {0.0, between(-0.1174, 0.5849, balance(1.8276, -1.7031)) * left}}});
}

/// Ends of the branches of an event, by mode.
std::map<std::vector<int>, std::vector<double>> branches_of(const Result& result, std::size_t event) {
  std::map<std::vector<int>, std::vector<double>> ends;
  for (const Result& branch : result.branches) {
    if (branch.left_at.value().event == event) ends[branch.final.mode] = branch.final.x;
  }
  return ends;
}

// Leaves C9-4 and C10-4: one of the two that attract is followed, the other is a branch of the event.
TEST(ShippedBranches, PartWaysAndSlideOrLeave) {
  struct Fork {
    std::string name;
    std::vector<double> followed;  ///< end state
    double x, y;                   ///< of the motion into x, y < 0
    std::size_t branches;          ///< their last modes
  };
  for (const Fork& fork : {Fork{"part-ways", {3.5, 1.4}, -1.5, -0.6, 4},
                           Fork{"slide-or-leave", {0.0, 1 - 1.2 * std::log(1.2)}, -2.625, -0.3, 5}}) {
    const Simulator model = Simulator::from_catalogue(fork.name);
    auto options = with(model.options(), fine);
    options.event.trajectories = 64;
    const Result result = model.run(options);
    ASSERT_EQ(result.status.termination, Termination::completed) << result.status.message;
    ASSERT_EQ(result.events.size(), 2U);
    EXPECT_NEAR(result.events[1].t, 1.0, 1e-12) << fork.name;
    for (const std::size_t i : {0U, 1U}) EXPECT_NEAR(result.final.x[i], fork.followed[i], 1e-11) << fork.name;
    const auto branches = branches_of(result, 1);
    EXPECT_EQ(branches.size(), fork.branches) << fork.name;
    const auto& other = branches.at({-1, -1});
    EXPECT_NEAR(other[0], fork.x, 1e-11) << fork.name;
    EXPECT_NEAR(other[1], fork.y, 1e-11) << fork.name;
  }
}

// The root that has lost its stability stays a motion of Filippov's: a branch that begins like a run in a forced mode.
TEST(ShippedBranches, StayOnARootThatHasLostItsStability) {
  for (const char* name : {"part-ways", "slide-or-leave"}) {
    const Simulator model = Simulator::from_catalogue(name);
    auto options = with(model.options(), fine);
    options.event.trajectories = 64;
    const Result result = model.run(options);
    EXPECT_EQ(result::not_followed(result), 0U) << name;
    const auto stays = [&](const Result& branch) {
      const auto& first = branch.events[0];
      return branch.left_at.value().event == 1 && first.mode_after == result::Mode{0, 0} &&
             branch.final.mode == *first.mode_after;
    };
    const auto branch = std::find_if(result.branches.begin(), result.branches.end(), stays);
    ASSERT_NE(branch, result.branches.end()) << name;
    EXPECT_EQ(branch->status.termination, Termination::completed) << branch->status.message;
    const auto& first = branch->events.front();
    EXPECT_EQ(first.kind, result::EventKind::start) << name;
    EXPECT_FALSE(first.mode_before.has_value()) << name;
    EXPECT_NEAR(first.t, 1.0, 1e-12) << name;
    EXPECT_EQ(first.alternatives.size(), result.events[1].alternatives.size()) << name;
    EXPECT_EQ(branch->trajectory.t.front(), first.t) << name;
    for (const std::size_t i : {0U, 1U}) EXPECT_NEAR(branch->final.x[i], 0.0, 1e-14) << name;
  }
}

// The other root on both surfaces lasts until t = 11/6; then x' = (t + 1)/4, y' = -17/10 is one of three ways.
TEST(ShippedBranches, TheOtherRootOfTheSameMode) {
  const Simulator model = Simulator::from_catalogue("slide-or-leave");
  auto options = with(model.options(), fine);
  options.event.trajectories = 64;
  const Result result = model.run(options);
  const auto changes = [](const Result& branch) {
    return branch.left_at.value().event == 1 && branch.events[0].kind == result::EventKind::start &&
           branch.events.size() == 2;
  };
  const auto branch = std::find_if(result.branches.begin(), result.branches.end(), changes);
  ASSERT_NE(branch, result.branches.end());
  const double exit = 11.0 / 6.0;
  const double until = 2.0;
  EXPECT_NEAR(branch->events[1].t, exit, 1e-11);
  EXPECT_EQ(branch->final.mode, (std::vector<int>{1, -1}));
  EXPECT_NEAR(branch->final.x[0], (until * until - exit * exit) / 8.0 + (until - exit) / 4.0, 1e-11);
  EXPECT_NEAR(branch->final.x[1], -1.7 * (until - exit), 1e-11);
}

// x' = sign(x) from 0: away to either side, or never.
TEST(ShippedBranches, SpontaneousSwitch) {
  const Simulator model = Simulator::from_catalogue("spontaneous-switch");
  const double until = model.options().until.value();
  expect_branches("spontaneous-switch", {{{-1}, {-until}}, {{0}, {0.0}}});
}

}  // namespace
}  // namespace saltus::problems
