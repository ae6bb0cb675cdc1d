// More sliding surfaces that influence each other than there are corners to look at.
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "run_model.hpp"

namespace saltus::event_integrator {
namespace {

using casadi::SX;
using model::Builder;
using result::Termination;

/// x_j' = drive_j(t) - sign(x_j) + forward sign(x_(j-1)) + backward sign(x_(j+1)).
struct Chain {
  int surfaces = 0;
  double forward = 0.0, backward = 0.0;
  bool at_zero = false;  ///< all of them, at the start
};

Integration run_chain(const Chain& chain) {
  Builder b("chain");
  std::vector<SX> x, sign;
  for (int j = 0; j < chain.surfaces; ++j) {
    x.push_back(b.state("x" + std::to_string(j), {chain.at_zero ? 0.0 : 0.3 + 0.1 * (7 * j % 5)}));
    sign.push_back(2 * b.step(b.switching("s" + std::to_string(j), x.back())) - 1);
  }
  for (std::size_t j = 0; j < x.size(); ++j) {
    SX rate = 0.75 * SX::sin(0.9 * b.time() + static_cast<double>(j)) - sign[j];
    if (j > 0) rate += chain.forward * sign[j - 1];
    if (j + 1 < x.size()) rate += chain.backward * sign[j + 1];
    b.dynamics("x" + std::to_string(j), rate);
  }
  return testing::run_model(b, 10.0, {1e-9, 1e-11});
}

/// Events of the surfaces below `surfaces`: times and numbers.
std::vector<std::pair<double, int>> events_of(const Integration& run, int surfaces) {
  std::vector<std::pair<double, int>> events;
  for (const auto& event : run.events) {
    for (const auto& name : event.surfaces) {
      const int j = std::stoi(name.substr(1));
      if (j < surfaces) events.emplace_back(event.t, j);
    }
  }
  return events;
}

TEST(ManySurfaces, AOneWayChainHasTheEventsOfItsBeginning) {
  // Four surfaces are decided by their tables; what follows them in the chain does not act on them.
  const auto few = run_chain({4, 0.35, 0.0});
  ASSERT_EQ(few.status.termination, Termination::completed) << few.status.message;
  for (const int n : {13, 30}) {
    const auto many = run_chain({n, 0.35, 0.0});
    ASSERT_EQ(many.status.termination, Termination::completed) << many.status.message;
    const auto expected = events_of(few, 4), found = events_of(many, 4);
    ASSERT_EQ(found.size(), expected.size());
    EXPECT_GT(expected.size(), 3U);
    for (std::size_t i = 0; i < found.size(); ++i) {
      EXPECT_NEAR(found[i].first, expected[i].first, 1e-9);
      EXPECT_EQ(found[i].second, expected[i].second);
    }
  }
}

/// x_j' = cos(t + j)/2 - sign(x_j) from 0, where sign(x_j) = cos(t + j)/2 = y_j'; and z' = sign(x_0) + sign(x_1).
Integration run_alone(int surfaces, bool with_sum) {
  Builder b("alone");
  std::vector<SX> sign;
  for (int j = 0; j < surfaces; ++j) {
    const std::string number = std::to_string(j);
    const SX x = b.state("x" + number, {0.0});
    b.state("y" + number, {0.0});
    sign.push_back(2 * b.step(b.switching("s" + number, x)) - 1);
    b.dynamics("x" + number, 0.5 * SX::cos(b.time() + j) - sign.back());
    b.dynamics("y" + number, sign.back());
  }
  if (with_sum) {
    b.state("z", {0.0});
    b.dynamics("z", sign[0] + sign[1]);
  }
  return testing::run_model(b, 5.0, {1e-9, 1e-11});
}

TEST(ManySurfaces, ThoseThatDoNotInfluenceEachOtherCostTwoEvaluationsOrThreeWhereARowHasSeveral) {
  constexpr int surfaces = 40;
  const auto each = run_alone(surfaces, false), sum = run_alone(surfaces, true);
  const auto travelled = [](int j) { return 0.5 * (std::sin(5.0 + j) - std::sin(static_cast<double>(j))); };
  for (const auto* run : {&each, &sum}) {
    ASSERT_EQ(run->status.termination, Termination::completed) << run->status.message;
    for (int j = 0; j < surfaces; ++j) {
      EXPECT_EQ(run->final.x[2 * static_cast<std::size_t>(j)], 0.0);
      EXPECT_NEAR(run->final.x[2 * static_cast<std::size_t>(j) + 1], travelled(j), 1e-8);
    }
  }
  EXPECT_NEAR(sum.final.x.back(), travelled(0) + travelled(1), 1e-8);
  EXPECT_LT(each.statistics.rhs_evaluations, 0.75 * static_cast<double>(sum.statistics.rhs_evaluations));
}

TEST(ManySurfaces, ThoseThatFeelTheirNeighboursKeepTheirBalance) {
  const auto run = run_chain({30, 0.2, 0.2});
  ASSERT_EQ(run.status.termination, Termination::completed) << run.status.message;
  // All are slid on at last, or have left by an exit at which the balance of the fields says so.
  int left = 0;
  for (const auto& event : run.events) left += event.kind == result::EventKind::leave_sliding ? 1 : 0;
  EXPECT_GT(left, 3);
  EXPECT_GT(run.events.size(), 30U);
}

TEST(ManySurfaces, WhatFeelsOthersMoreThanItselfIsNotDecided) {
  const auto run = run_chain({16, 0.9, 0.9, true});
  ASSERT_EQ(run.status.termination, Termination::outside_class);
  EXPECT_NE(run.status.message.find("16 of them depend on each other, more than themselves"), std::string::npos)
      << run.status.message;
}

TEST(ManySurfaces, AllAtZeroAtTheStartAreDecidedTogether) {
  const auto run = run_chain({40, 0.2, 0.2, true});
  ASSERT_EQ(run.status.termination, Termination::completed) << run.status.message;
}

}  // namespace
}  // namespace saltus::event_integrator
