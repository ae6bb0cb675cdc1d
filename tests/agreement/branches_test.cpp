// Shipped models whose solutions are not unique, with --branch all: every motion is found, and ends where it should.
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

// Leaf E10. Along x = 0 with alpha = 0.5223/(0.5223 + 1.7734), then the field of x > 0, y > 0.
TEST(ShippedBranches, StayOrLeave) {
  const double alpha = 0.5223 / (0.5223 + 1.7734);
  const double left = 6.0 - 1.0 / (0.609 * (1.0 - alpha) - 0.9416 * alpha);
  expect_branches("stay-or-leave", {{{1, 1}, {1.011 * left, 0.115 * left}}});
}

// Leaf E12: along x = 0 below, and above with alpha = 1.8276/(1.8276 + 1.7031).
TEST(ShippedBranches, StayOrSlide) {
  const double below = 0.4168 / (0.4168 + 1.4013);
  const double above = 1.8276 / (1.8276 + 1.7031);
  const double left = 36.0 - 1.0 / (0.3463 * (1.0 - below) - 0.904 * below);
  expect_branches("stay-or-slide", {{{0, 1}, {0.0, (-0.1174 * (1.0 - above) + 0.5849 * above) * left}}});
}

// x' = sign(x) from 0: away to either side, or never.
TEST(ShippedBranches, SpontaneousSwitch) {
  const Simulator model = Simulator::from_catalogue("spontaneous-switch");
  const double until = model.options().until;
  expect_branches("spontaneous-switch", {{{-1}, {-until}}, {{0}, {0.0}}});
}

}  // namespace
}  // namespace saltus::problems
