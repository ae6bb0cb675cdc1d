#include "saltus/switching/hidden/group_modes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "hidden_instances.hpp"
#include "saltus/switching/plane/admissible_modes.hpp"

namespace saltus::switching {
namespace {

CornerTable random_table(int surfaces, std::mt19937_64& random) {
  std::uniform_real_distribution<double> velocity(-1.0, 1.0);
  CornerTable table;
  table.surfaces = surfaces;
  table.arrival.assign(static_cast<std::size_t>(surfaces), Arrival::at_start);
  for (std::size_t i = 0; i < static_cast<std::size_t>(surfaces) * table.corners(); ++i) {
    const double v = velocity(random);
    table.sides.push_back({v, v > 0.0 ? Drift::up : Drift::down});
  }
  return table;
}

TEST(GroupModes, OfTwoSurfacesAreThoseOfThePlane) {
  std::mt19937_64 random(21);
  std::size_t found = 0;
  for (int n = 0; n < 2000; ++n) {
    const CornerTable table = random_table(2, random);
    const auto modes = admissible_modes(table);
    const auto plane = admissible_modes(plane_table(table));
    ASSERT_EQ(modes.size(), plane.size()) << n;
    for (const auto& mode : modes) {
      const auto is_it = [&](const PlaneContinuation& other) {
        return other.mode[0] == mode.mode[0] && other.mode[1] == mode.mode[1] &&
               std::abs(other.alpha[0] - mode.alpha[0]) + std::abs(other.alpha[1] - mode.alpha[1]) < 1e-9;
      };
      EXPECT_TRUE(std::any_of(plane.begin(), plane.end(), is_it)) << n;
    }
    found += modes.size();
  }
  EXPECT_GT(found, 2000U);
}

/// Roots of three trilinear functions in the cube by Newton's method from many points.
std::size_t roots_from_everywhere(const MultiAffine& g) {
  constexpr int starts = 10;
  std::vector<std::vector<double>> roots;
  SelectionNewton newton(3);
  for (int i = 0; i < starts * starts * starts; ++i) {
    std::vector<double> alpha{(0.5 + i % starts) / starts, (0.5 + i / starts % starts) / starts,
                              (0.5 + i / starts / starts) / starts};
    if (!newton.solve([&](const double* a, double* v) { g.evaluate(a, v); }, alpha.data())) continue;
    const auto is_same = [&](const auto& root) {
      return std::equal(root.begin(), root.end(), alpha.begin(),
                        [](double a, double b) { return std::abs(a - b) < 1e-7; });
    };
    const bool inside = std::all_of(alpha.begin(), alpha.end(), [](double a) { return 0.0 < a && a < 1.0; });
    if (inside && std::none_of(roots.begin(), roots.end(), is_same)) roots.push_back(alpha);
  }
  return roots.size();
}

TEST(GroupModes, OfThreeSurfacesSatisfyTheirInequalitiesAndNoRootIsMissed) {
  std::mt19937_64 random(22);
  std::size_t roots = 0;
  for (int n = 0; n < 200; ++n) {
    const CornerTable table = random_table(3, random);
    const MultiAffine g(table);
    std::size_t inside = 0;
    for (const auto& mode : admissible_modes(table)) {
      std::array<double, 3> velocity{};
      g.evaluate(mode.alpha.data(), velocity.data());
      for (std::size_t j = 0; j < 3; ++j) {
        if (mode.mode[j] == 0) {
          EXPECT_NEAR(velocity[j], 0.0, 1e-12);
          EXPECT_TRUE(mode.alpha[j] > 0.0 && mode.alpha[j] < 1.0);
        } else {
          EXPECT_GT(velocity[j] * mode.mode[j], 0.0);
          EXPECT_EQ(mode.alpha[j], mode.mode[j] > 0 ? 1.0 : 0.0);
        }
      }
      inside += mode.mode == std::vector<int>(3, 0) ? 1U : 0U;
    }
    EXPECT_EQ(inside, roots_from_everywhere(g)) << n;
    roots += inside;
  }
  EXPECT_GT(roots, 50U);
}

TEST(GroupModes, HoldTheModeThatTheHiddenDynamicsSettlesIn) {
  for (const int m : {3, 4}) {
    int unique = 0;
    for (const auto& one : random_entries(m, 60, 23)) {
      const auto decision = one.decide();
      if (decision.limit != HiddenLimit::settled) continue;
      CornerTable table;
      table.surfaces = m;
      table.arrival = one.situation.arrival;
      for (int j = 0; j < m; ++j) {
        for (std::size_t corner = 0; corner < table.corners(); ++corner) {
          const double v = one.g.value(j, corner);
          table.sides.push_back({v, v > 0.0 ? Drift::up : Drift::down});
        }
      }
      const auto modes = admissible_modes(table);
      const auto is_chosen = [&](const GroupMode& mode) {
        return mode.mode == decision.mode && std::equal(mode.alpha.begin(), mode.alpha.end(), decision.alpha.begin(),
                                                        [](double a, double b) { return std::abs(a - b) < 1e-8; });
      };
      EXPECT_EQ(std::count_if(modes.begin(), modes.end(), is_chosen), 1);
      unique += modes.size() == 1 ? 1 : 0;
    }
    EXPECT_GT(unique, 2) << m;
  }
}

/// The rows (a, b, c, d) of velocities at the corners 00, 10, 01, 11.
CornerTable plane_of(const std::array<std::array<double, 4>, 2>& velocities) {
  CornerTable table;
  table.surfaces = 2;
  table.arrival.assign(2, Arrival::at_start);
  for (const auto& row : velocities) {
    for (const double v : row) {
      table.sides.push_back({v, v > 0.0 ? Drift::up : v < 0.0 ? Drift::down : Drift::stays});
    }
  }
  return table;
}

TEST(GroupModes, ARootOnTheEdgeIsBorderline) {
  // At alpha_1 = 1: -3/2 + 7/2 alpha_2 = 0 and 3 - 7 alpha_2 = 0, with the stable Jacobian (-25/14, 7/2; 5/14, -7). The
  // other root (1/10, 12/13) is a saddle.
  const CornerTable table = plane_of({{{3.5, -1.5, -0.5, 2.0}, {-1.0, 3.0, 0.5, -4.0}}});
  const auto strict = admissible_modes(table);
  for (const auto& mode : strict) EXPECT_LT(mode.alpha[0], 0.2);
  std::size_t found = 0;
  for (const auto& mode : admissible_modes(table, Borderline::kept)) {
    if (mode.mode != std::vector<int>{0, 0}) continue;
    ++found;
    EXPECT_NEAR(mode.alpha[0], 1.0, 1e-14);
    EXPECT_NEAR(mode.alpha[1], 3.0 / 7.0, 1e-14);
  }
  EXPECT_EQ(found, 1U);
}

TEST(GroupModes, MotionAlongASurfaceIsBorderline) {
  // Right of psi_1 = 0 both fields point to psi_2 = 0, and the sliding motion there, half of each, is along psi_1 = 0.
  const CornerTable table = plane_of({{{1.0, 1.0, 1.0, -1.0}, {1.0, 1.0, -1.0, -1.0}}});
  const auto is_it = [](const GroupMode& mode) { return mode.mode == std::vector<int>{1, 0}; };
  const auto strict = admissible_modes(table);
  EXPECT_TRUE(std::none_of(strict.begin(), strict.end(), is_it));
  const auto kept = admissible_modes(table, Borderline::kept);
  EXPECT_TRUE(std::any_of(kept.begin(), kept.end(), is_it));
}

}  // namespace
}  // namespace saltus::switching
