#include "saltus/switching/table/surface_decision.hpp"

#include <cmath>
#include <cstddef>
#include <random>

#include <gtest/gtest.h>

#include "saltus/switching/selections/selection_root.hpp"
#include "saltus/switching/table/group_decision.hpp"
#include "switching_cases.hpp"

namespace saltus::switching {
namespace {

Side side(double velocity) {
  return {velocity, velocity > 0.0 ? Drift::up : velocity < 0.0 ? Drift::down : Drift::stays};
}

TEST(SurfaceDecision, CrossesWhereBothFieldsAgree) {
  EXPECT_EQ(decide_surface({side(1.0), side(0.1), Arrival::from_below}).mode, +1);
  EXPECT_EQ(decide_surface({side(-1.0), side(-0.1), Arrival::from_above}).mode, -1);
}

TEST(SurfaceDecision, SlidesWithTheSelectionThatMakesTheFieldTangent) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> positive(1e-6, 10.0);
  for (int i = 0; i < 1000; ++i) {
    const double below = positive(random);
    const double above = -positive(random);
    const auto decision = decide_surface({side(below), side(above), Arrival::from_below});
    ASSERT_EQ(decision.mode, 0);
    EXPECT_GT(decision.alpha, 0.0);
    EXPECT_LT(decision.alpha, 1.0);
    EXPECT_NEAR((1.0 - decision.alpha) * below + decision.alpha * above, 0.0, 4e-15 * (below - above));
    EXPECT_TRUE(decision.other_modes.empty());
  }
}

TEST(SurfaceDecision, RepellingSurfaceIsReportedAsNotUnique) {
  const auto decision = decide_surface({side(-1.0), side(1.0), Arrival::at_start});
  EXPECT_EQ(decision.mode, +1);
  EXPECT_EQ(decision.other_modes, (std::vector<int>{-1, 0}));
}

TEST(SurfaceDecision, TangenciesAreDecidedByTheDriftNotByTheVelocity) {
  EXPECT_EQ(decide_surface({{0.0, Drift::down}, side(-1.0), Arrival::along}).mode, -1);
  EXPECT_EQ(decide_surface({side(1.0), {0.0, Drift::up}, Arrival::along}).mode, +1);
  const auto tangential_entry = decide_surface({{0.0, Drift::up}, side(-1.0), Arrival::from_below});
  EXPECT_EQ(tangential_entry.mode, 0);
  EXPECT_EQ(tangential_entry.alpha, 0.0);
}

TEST(SurfaceDecision, TwoFoldAndStandingAreNotGuessed) {
  EXPECT_EQ(decide_surface({{0.0, Drift::up}, {0.0, Drift::down}, Arrival::from_below}).verdict, Verdict::two_fold);
  EXPECT_EQ(decide_surface({side(0.0), side(0.0), Arrival::at_start}).verdict, Verdict::stands);
}

TEST(SurfaceDecision, InvariantUnderScalingByPowersOfTwo) {
  for (const double scale : {std::ldexp(1.0, 26), std::ldexp(1.0, -26)}) {
    const auto one = decide_surface({side(0.3), side(-0.7), Arrival::from_below});
    const auto scaled = decide_surface({side(0.3 * scale), side(-0.7 * scale), Arrival::from_below});
    EXPECT_EQ(one.alpha, scaled.alpha);
  }
}

TEST(SurfaceDecision, VerifiedCasesAndTheirMirrorImages) {
  int cases = 0;
  const auto data = all_cases();
  for (const auto& c : data) {
    if (c.contains("f2")) continue;
    ++cases;
    for (const int sign : {1, -1}) {  // the mirror image exchanges the sides and the signs
      const auto at = [&c, sign](const char* key) {
        Side result = side(sign * c["f1"][key].get<double>());
        // A tangent field is on its way out: its normal component grows along the sliding solution.
        if (result.drift == Drift::stays) result.drift = side(sign * c["dfdt"]["df1"][key].get<double>()).drift;
        return result;
      };
      const bool was_sliding = c["situation"] == "exit_codim1";
      Arrival arrival = Arrival::along;
      if (!was_sliding) arrival = sign * c["incoming"][0].get<int>() < 0 ? Arrival::from_below : Arrival::from_above;
      const auto decision = decide_surface({at(sign > 0 ? "-" : "+"), at(sign > 0 ? "+" : "-"), arrival});
      EXPECT_EQ(decision.mode, sign * c["expected"][0]["mode"][0].get<int>()) << c["id"];
      EXPECT_TRUE(decision.other_modes.empty()) << c["id"];
      const auto& lambda = c["expected"][0]["lambda"][0];
      if (lambda.is_null()) continue;
      EXPECT_NEAR(2.0 * decision.alpha - 1.0, sign * lambda.get<double>(), 1e-14) << c["id"];
    }
  }
  EXPECT_EQ(cases, 40);
}

/// Table of m surfaces from functions g_j(corner).
template <class G>
CornerTable table_of(int surfaces, G&& g) {
  CornerTable table;
  table.surfaces = surfaces;
  table.arrival.assign(static_cast<std::size_t>(surfaces), Arrival::from_below);
  for (int j = 0; j < surfaces; ++j) {
    for (std::size_t corner = 0; corner < table.corners(); ++corner) table.sides.push_back(side(g(j, corner)));
  }
  return table;
}

bool bit(std::size_t corner, int j) { return (corner >> j & 1U) != 0; }

TEST(GroupDecision, DecoupledSurfacesAreDecidedOneByOne) {
  const auto decision = decide_group(table_of(3, [](int j, std::size_t corner) {
    if (j == 0) return bit(corner, 0) ? -1.0 : 3.0;  // slides at 3/4
    if (j == 1) return 2.0;                          // crosses
    return bit(corner, 2) ? -2.0 : 2.0;              // slides at 1/2
  }));
  ASSERT_EQ(decision.verdict, Verdict::decided);
  EXPECT_EQ(decision.surfaces[0].mode, 0);
  EXPECT_DOUBLE_EQ(decision.surfaces[0].alpha, 0.75);
  EXPECT_EQ(decision.surfaces[1].mode, 1);
  EXPECT_DOUBLE_EQ(decision.surfaces[2].alpha, 0.5);
}

TEST(GroupDecision, TriangularInfluenceIsResolvedInOrder) {
  // Surface 1 crosses by itself; behind it surface 0 stops attracting.
  const auto decision = decide_group(table_of(2, [](int j, std::size_t corner) {
    if (j == 1) return 1.0;
    return bit(corner, 1) ? 2.0 : (bit(corner, 0) ? -1.0 : 1.0);
  }));
  ASSERT_EQ(decision.verdict, Verdict::decided);
  EXPECT_EQ(decision.surfaces[1].mode, 1);
  EXPECT_EQ(decision.surfaces[0].mode, 1);
}

TEST(GroupDecision, SlidingSelectionEntersTheOthersByInterpolation) {
  // Surface 0 slides at 1/4; the normal component on 1 is then 1 - 8 alpha_0 = -1 below and above.
  const auto decision = decide_group(table_of(2, [](int j, std::size_t corner) {
    if (j == 0) return bit(corner, 0) ? -3.0 : 1.0;
    return 1.0 - (bit(corner, 0) ? 8.0 : 0.0);
  }));
  ASSERT_EQ(decision.verdict, Verdict::decided);
  EXPECT_EQ(decision.surfaces[0].mode, 0);
  EXPECT_EQ(decision.surfaces[1].mode, -1);
}

TEST(GroupDecision, GenuinelyCoupledSurfacesAreRefused) {
  // Filippov's spiral: neither surface has a definite sign or its own dynamics.
  const auto decision = decide_group(table_of(2, [](int j, std::size_t corner) {
    const double s1 = bit(corner, 0) ? 1.0 : -1.0;
    const double s2 = bit(corner, 1) ? 1.0 : -1.0;
    return j == 0 ? -s1 + 2.0 * s2 : -2.0 * s1 - s2;
  }));
  EXPECT_EQ(decision.verdict, Verdict::coupled);
  EXPECT_GE(decision.culprit, 0);
}

TEST(GroupDecision, RepellingBehindAnEliminationIsLeftToTheTransient) {
  const auto decision = decide_group(table_of(2, [](int j, std::size_t corner) {
    if (j == 1) return 1.0;
    if (!bit(corner, 1)) return bit(corner, 0) ? -1.0 : 1.0;
    return bit(corner, 0) ? 1.0 : -1.0;
  }));
  EXPECT_EQ(decision.verdict, Verdict::coupled);
}

TEST(SelectionRoot, TakesTheFirstZeroFromTheSideOfArrival) {
  // g = -(a - 0.2)(a - 0.5)(a - 0.8): zeros at which g falls are 0.2 and 0.8.
  const auto g = [](double a) { return -(a - 0.2) * (a - 0.5) * (a - 0.8); };
  SurfaceSituation situation{side(g(0.0)), side(g(1.0)), Arrival::from_below};
  auto decision = decide_selection(situation, g, 0.0);
  EXPECT_EQ(decision.mode, 0);
  EXPECT_NEAR(decision.alpha, 0.2, 1e-15);
  EXPECT_FALSE(decision.other_modes.empty());
  situation.arrival = Arrival::from_above;
  EXPECT_NEAR(decide_selection(situation, g, 0.0).alpha, 0.8, 1e-15);
}

TEST(SelectionRoot, CrossesWhereThereIsNoZeroAndScansOnAfterALoss) {
  const auto none = [](double a) { return 1.0 + a; };
  EXPECT_EQ(decide_selection({side(1.0), side(2.0), Arrival::from_below}, none, 0.0).mode, 1);
  // The pair of zeros at 0.3 has just vanished (g > 0 there); the next one upwards is 0.9.
  const auto lost = [](double a) { return ((a - 0.3) * (a - 0.3) + 1e-9) * (0.9 - a); };
  const auto decision = decide_selection({side(lost(0.0)), side(lost(1.0)), Arrival::along}, lost, 0.3);
  EXPECT_EQ(decision.mode, 0);
  EXPECT_NEAR(decision.alpha, 0.9, 1e-12);
}

}  // namespace
}  // namespace saltus::switching
