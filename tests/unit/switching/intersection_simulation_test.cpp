// The decision trees against the hidden dynamics itself, on random fields.
#include <string>

#include <gtest/gtest.h>

#include "hidden_simulation.hpp"
#include "random_fields.hpp"
#include "saltus/switching/plane/intersection.hpp"

namespace saltus::switching {
namespace {

using Fields = Velocities;
using Point = HiddenSimulation::Point;

std::string text(const Fields& f) {
  std::string result;
  for (const auto& row : f) {
    for (const double velocity : row) result += std::to_string(velocity) + " ";
  }
  return result;
}

struct Count {
  int compared = 0, moving = 0;
};

/// The outcomes of the hidden dynamics from u are the decision's, for all scalings; a limit cycle is sliding.
void compare(const PlaneDecision& decision, const Fields& f, const Point& u, const Point& kappa, Count& count) {
  const auto outcome = HiddenSimulation(f, kappa).outcome(u, 1000000);
  if (!outcome) ++count.moving;
  EXPECT_EQ(outcome.value_or(std::array{0, 0}), decision.chosen.mode)
      << name(decision.leaf) << " kappa " << kappa[0] << " " << kappa[1] << " " << text(f);
  ++count.compared;
}

TEST(IntersectionSimulation, Entering) {
  RandomFields random(11);
  Count count;
  while (count.compared < 1500) {
    const Fields f = random.fields();
    if (!(f[0][0] > 0.0 && f[0][1] < 0.0 && f[0][0] * f[1][1] - f[0][1] * f[1][0] > 0.0)) continue;
    const auto decision = decide_entering(plane_table(f), {0, -1});
    if (decision.ambiguous) continue;  // a matter of the scaling
    const double alpha = f[0][0] / (f[0][0] - f[0][1]);
    for (const Point& kappa : scalings) compare(decision, f, {alpha, 0.0}, kappa, count);
  }
  EXPECT_LT(count.moving, count.compared / 50);
}

TEST(IntersectionSimulation, EnteringWhereTheScalingDecides) {
  RandomFields random(12);
  int sliding = 0;
  int leaving = 0;
  for (int n = 0; n < 50;) {
    const Fields f = random.fields();
    if (!(f[0][0] > 0.0 && f[0][1] < 0.0 && f[0][0] * f[1][1] - f[0][1] * f[1][0] > 0.0)) continue;
    const auto active = decide_entering(plane_table(f), {0, -1}, SelectionPolicy::active_dominant);
    if (!active.ambiguous) continue;
    ++n;
    const auto passive = decide_entering(plane_table(f), {0, -1}, SelectionPolicy::passive_dominant);
    EXPECT_FALSE(active.unique());
    EXPECT_NE(active.chosen.mode, passive.chosen.mode);
    const double alpha = f[0][0] / (f[0][0] - f[0][1]);
    for (const double ratio : {0.01, 1.0, 100.0}) {
      const auto mode = HiddenSimulation(f, {1.0, ratio}).outcome({alpha, 0.0}, 400000).value_or(std::array{0, 0});
      EXPECT_TRUE(mode == active.chosen.mode || mode == passive.chosen.mode) << text(f);
      if (ratio < 1.0) sliding += mode == active.chosen.mode ? 1 : 0;
      if (ratio > 1.0) leaving += mode == passive.chosen.mode ? 1 : 0;
    }
  }
  // The limits of the ratio of scalings; a ratio of 100 is not far enough in all cases.
  EXPECT_GE(sliding, 47);
  EXPECT_GE(leaving, 40);
}

TEST(IntersectionSimulation, ArrivalAtTheCorner) {
  RandomFields random(13);
  Count count;
  while (count.compared < 1500) {
    const Fields f = random.fields();
    if (!(f[0][0] > 0.0 && f[1][0] > 0.0)) continue;
    const auto decision = decide_corner_arrival(plane_table(f), {-1, -1});
    EXPECT_EQ(decision.undecided.empty(), decision.leaf == Leaf::P1);
    if (decision.leaf != Leaf::P1) continue;
    for (const Point& kappa : scalings) compare(decision, f, {0.0, 0.0}, kappa, count);
  }
  EXPECT_LT(count.moving, count.compared / 50);
}

TEST(IntersectionSimulation, ExitThroughTheCorner) {
  RandomFields random(14);
  Count count;
  while (count.compared < 1500) {
    Fields f = random.fields();
    f[0][3] = f[1][3] = 0.0;
    const double g11 = -f[0][2], g12 = -f[0][1], g21 = -f[1][2], g22 = -f[1][1];
    if (!(g11 * g22 - g12 * g21 > 0.0)) continue;
    // Behind the event the root is at (1, 1) + beyond.
    const Point beyond{std::abs(random.uniform()), std::abs(random.uniform())};
    const Point drift{-(g11 * beyond[0] + g12 * beyond[1]), -(g21 * beyond[0] + g22 * beyond[1])};
    PlaneTable table = plane_table(f);
    for (std::size_t j = 0; j < 2; ++j) table.sides[j][3].drift = drift[j] > 0.0 ? Drift::up : Drift::down;
    const auto decision = decide_exit_corner(table, {1, 1});
    if (!decision.undecided.empty()) continue;
    Fields later = f;
    for (std::size_t j = 0; j < 2; ++j) {
      for (double& velocity : later[j]) velocity += 1e-4 * drift[j];
    }
    for (const Point& kappa : scalings) {
      const bool was_stable = kappa[0] * g11 + kappa[1] * g22 < 0.0;
      if (was_stable) compare(decision, later, {1.0, 1.0}, kappa, count);
    }
  }
  EXPECT_LT(count.moving, count.compared / 50);
}

}  // namespace
}  // namespace saltus::switching
