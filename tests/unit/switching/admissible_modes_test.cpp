#include "saltus/switching/plane/admissible_modes.hpp"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "random_fields.hpp"
#include "saltus/switching/plane/intersection.hpp"

namespace saltus::switching {
namespace {

double at(const std::array<double, 4>& f, const PlaneAlpha& alpha) {
  const auto [x, y] = alpha;
  return (1 - x) * (1 - y) * f[0] + x * (1 - y) * f[1] + (1 - x) * y * f[2] + x * y * f[3];
}

/// A solution in the mode stays on the surfaces it slides on and leaves the others to the side of the mode.
void expect_admissible(const PlaneContinuation& mode, const Velocities& f) {
  for (std::size_t j = 0; j < 2; ++j) {
    EXPECT_GE(mode.alpha[j], 0.0);
    EXPECT_LE(mode.alpha[j], 1.0);
    const double velocity = at(f[j], mode.alpha);
    if (mode.mode[j] == 0) {
      EXPECT_NEAR(velocity, 0.0, 1e-13);
    } else {
      EXPECT_EQ(mode.alpha[j], mode.mode[j] > 0 ? 1.0 : 0.0);
      EXPECT_GT(velocity * mode.mode[j], 0.0);
    }
  }
}

TEST(AdmissibleModes, AreAdmissibleAndAllThereAre) {
  RandomFields random(31);
  for (int n = 0; n < 5000; ++n) {
    const Velocities f = random.fields();
    const PlaneModes modes = admissible_modes(plane_table(f));
    for (const auto& mode : modes) expect_admissible(mode, f);
    std::size_t regions = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      const bool leaves = ((k & 1U) != 0 ? 1 : -1) * f[0][k] > 0.0 && ((k & 2U) != 0 ? 1 : -1) * f[1][k] > 0.0;
      regions += leaves ? 1 : 0;
    }
    std::size_t edges = 0;
    for (const std::size_t j : {0U, 1U}) {
      for (const int side : {-1, 1}) {
        const std::size_t below = side > 0 ? std::size_t{2} >> j : 0;  // the bit of the other surface
        const double low = f[j][below];
        const double high = f[j][below | std::size_t{1} << j];
        if (low * high >= 0.0) continue;
        const double mixed = f[1 - j][below] * std::abs(high) + f[1 - j][below | std::size_t{1} << j] * std::abs(low);
        edges += mixed * side > 0.0 ? 1 : 0;
      }
    }
    const auto count = [&modes](auto&& wanted) {
      return static_cast<std::size_t>(std::count_if(modes.begin(), modes.end(), wanted));
    };
    EXPECT_EQ(count([](const auto& m) { return m.mode[0] != 0 && m.mode[1] != 0; }), regions);
    EXPECT_EQ(count([](const auto& m) { return (m.mode[0] == 0) != (m.mode[1] == 0); }), edges);
  }
}

TEST(AdmissibleModes, AttractingOnesAreLimitsOfTheHiddenDynamics) {
  // One surface repels, the other attracts: sliding on the second only; and all four regions leave.
  const Velocities f{{{-1.0, 1.0, -1.0, 1.0}, {1.0, 1.0, -1.0, -1.0}}};
  for (const auto& mode : admissible_modes(plane_table(f))) {
    EXPECT_EQ(mode.attracts, mode.mode != (PlaneMode{0, 0})) << mode.mode[0] << mode.mode[1];
  }
  EXPECT_EQ(admissible_modes(plane_table(f)).size(), 3U);  // sliding on both, sliding on psi_2 to either side
}

TEST(AdmissibleModes, TangenciesByTheirDrift) {
  // The field of (++) is tangent to the first surface and turns to either side.
  PlaneTable table = plane_table({{{1.0, 1.0, -1.0, 0.0}, {1.0, 1.0, 1.0, 1.0}}});
  const auto has_region = [&table] {
    const auto modes = admissible_modes(table);
    return std::any_of(modes.begin(), modes.end(), [](const auto& m) { return m.mode == PlaneMode{1, 1}; });
  };
  EXPECT_FALSE(has_region());
  table.sides[0][3].drift = Drift::up;
  EXPECT_TRUE(has_region());
  table.sides[0][3].drift = Drift::down;
  EXPECT_FALSE(has_region());
}

TEST(AdmissibleModes, TheChosenModeIsAmongThemAndTheOthersAreTheRest) {
  RandomFields random(32);
  int unique = 0;
  int entries = 0;
  while (entries < 5000) {
    const Velocities f = random.fields();
    if (!(f[0][0] > 0.0 && f[0][1] < 0.0 && f[0][0] * f[1][1] - f[0][1] * f[1][0] > 0.0)) continue;
    ++entries;
    const PlaneTable table = plane_table(f);
    const auto decision = decide_entering(table, {0, -1});
    ASSERT_EQ(decision.undecided, "");
    expect_admissible(decision.chosen, f);
    EXPECT_TRUE(decision.chosen.attracts);
    EXPECT_EQ(decision.others.size() + 1, admissible_modes(table).size());
    for (const auto& other : decision.others) EXPECT_NE(other.alpha, decision.chosen.alpha);
    if (decision.leaf == Leaf::E3 || decision.leaf == Leaf::E6 || decision.leaf == Leaf::E11) {
      EXPECT_TRUE(decision.unique());
    }
    if (decision.leaf == Leaf::E10 || decision.leaf == Leaf::E12) {
      EXPECT_FALSE(decision.unique());
    }
    unique += decision.unique() ? 1 : 0;
  }
  EXPECT_NEAR(unique / 5000.0, 0.8, 0.05);
}

}  // namespace
}  // namespace saltus::switching
