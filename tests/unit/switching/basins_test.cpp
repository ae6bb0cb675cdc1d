// Basins of the hidden dynamics where a root has lost its stability: Fig. 13 of [guglielmi2022].
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "saltus/switching/hidden/hidden_dynamics.hpp"

namespace saltus::switching {
namespace {

using Point = std::array<double, 2>;

/// The model part-ways at its exit, leaf C9-4, over selections alpha = (1 + lambda)/2:
///   g_1 = lambda_2 + lambda_1 lambda_2 / 2,   g_2 = -lambda_1 / 2 + lambda_2 + lambda_1 lambda_2 / 5.
Point velocity(const Point& alpha) {
  const double l1 = 2 * alpha[0] - 1, l2 = 2 * alpha[1] - 1;
  return {l2 + l1 * l2 / 2, -l1 / 2 + l2 + l1 * l2 / 5};
}

/// Default speeds: over the largest component at a corner.
constexpr Point largest_speeds{1.5, 1.7};

std::vector<int> ends_in(const Point& start) {
  const HiddenSituation situation{{Arrival::along, Arrival::along}, {start[0], start[1]}};
  const auto g = [](const double* alpha, double* result) {
    const Point at = velocity({alpha[0], alpha[1]});
    result[0] = at[0];
    result[1] = at[1];
  };
  const auto decision = decide_by_hidden_dynamics(2, g, situation);
  EXPECT_EQ(decision.limit, HiddenLimit::settled) << start[0] << ", " << start[1];
  return decision.mode;
}

const std::vector<int> both_up{1, 1}, both_down{-1, -1};

// Only the two regions across are reached, each from a part of the square; the picture is not symmetric.
TEST(Basins, OfTwoRegionsShareTheSquare) {
  constexpr int cells = 24;
  int ups = 0;
  for (int i = 0; i < cells; ++i) {
    for (int k = 0; k < cells; ++k) {
      const auto mode = ends_in({(i + 0.5) / cells, (k + 0.5) / cells});
      ASSERT_TRUE(mode == both_up || mode == both_down);
      ups += mode == both_up ? 1 : 0;
    }
  }
  EXPECT_GT(ups, cells * cells / 3);
  EXPECT_LT(ups, 2 * cells * cells / 3);
}

// The borders are the two unstable motions that slide out along psi_2 = 0. They enter the square, backwards in time,
// where g_2 = 0 on its left and right side, and wind around the root: each neighbourhood of it has both outcomes.
TEST(Basins, AreSeparatedByTheMotionsThatSlideOut) {
  struct Border {
    Point start;
    double side;  ///< on which it has `down`, looking along it into the square: to the right 1
  };
  for (const auto& [start, side] : {Border{{0.0, 3.0 / 16.0}, 1.0}, Border{{1.0, 17.0 / 24.0}, -1.0}}) {
    Point u = start;
    const auto backwards = [](const Point& at) {
      const Point g = velocity(at);
      return Point{-g[0] / largest_speeds[0], -g[1] / largest_speeds[1]};
    };
    int compared = 0;
    for (int step = 0; step < 20000; ++step) {
      const Point v = backwards(u);
      const double distance = std::hypot(u[0] - 0.5, u[1] - 0.5);
      if (step % 500 == 250 && distance > 1e-5) {
        const double across = 1e-3 * distance * side / std::hypot(v[0], v[1]);
        EXPECT_EQ(ends_in({u[0] + across * v[1], u[1] - across * v[0]}), both_down) << step;
        EXPECT_EQ(ends_in({u[0] - across * v[1], u[1] + across * v[0]}), both_up) << step;
        ++compared;
      }
      constexpr double h = 1e-3;
      const auto moved = [&](const Point& k, double part) {
        return Point{u[0] + part * h * k[0], u[1] + part * h * k[1]};
      };
      const Point k2 = backwards(moved(v, 0.5)), k3 = backwards(moved(k2, 0.5)), k4 = backwards(moved(k3, 1.0));
      for (std::size_t j = 0; j < 2; ++j) u[j] += h / 6 * (v[j] + 2 * (k2[j] + k3[j]) + k4[j]);
    }
    EXPECT_GT(compared, 20);
  }
}

}  // namespace
}  // namespace saltus::switching
