#include <vector>

#include <gtest/gtest.h>

#include "saltus/switching/table/group_decision.hpp"

namespace saltus::switching {
namespace {

/// velocity of surface j at a corner: the sum of weight[j][i] over the selections i that are 1, and 0.3 - j.
CornerTable affine_table(const std::vector<std::vector<double>>& weight) {
  CornerTable table;
  table.surfaces = static_cast<int>(weight.size());
  table.arrival.assign(weight.size(), Arrival::at_start);
  for (std::size_t j = 0; j < weight.size(); ++j) {
    for (std::size_t corner = 0; corner < table.corners(); ++corner) {
      double v = 0.3 - static_cast<double>(j);
      for (std::size_t i = 0; i < weight.size(); ++i) v += (corner >> i & 1U) != 0 ? weight[j][i] : 0.0;
      table.sides.push_back({v, v > 0.0 ? Drift::up : Drift::down});
    }
  }
  return table;
}

using Parts = std::vector<std::vector<int>>;

TEST(Influence, WhoFeelsNobodyComesFirst) {
  // 1 depends on itself, 2 depends on 1, 0 depends on 2.
  EXPECT_EQ(parts_by_influence(affine_table({{0.4, 0.0, 0.2}, {0.0, -0.5, 0.0}, {0.0, 0.1, -0.7}})),
            (Parts{{1}, {2}, {0}}));
  // 0 and 2 depend on each other, through 3; 1 depends on them.
  EXPECT_EQ(parts_by_influence(affine_table(
                {{-1.0, 0.0, 0.2, 0.0}, {0.3, -1.0, 0.0, 0.0}, {0.0, 0.0, -1.0, 0.4}, {0.5, 0.0, 0.0, -1.0}})),
            (Parts{{0, 2, 3}, {1}}));
  EXPECT_EQ(parts_by_influence(affine_table({{-1.0, 0.2}, {0.3, -1.0}})), (Parts{{0, 1}}));
  // Neither depends on the other, though they were met together.
  EXPECT_EQ(parts_by_influence(affine_table({{-1.0, 0.0}, {0.0, -1.0}})), (Parts{{0}, {1}}));
}

TEST(Influence, WhereASurfaceIsTangentItsNextDerivativeCounts) {
  CornerTable table = affine_table({{-1.0, 0.0}, {0.0, 0.0}});
  for (std::size_t corner = 0; corner < 4; ++corner) {
    table.sides[4 + corner] = {0.0, (corner & 1U) != 0 ? Drift::up : Drift::down};
  }
  EXPECT_EQ(parts_by_influence(table), (Parts{{0}, {1}}));
  for (std::size_t corner = 0; corner < 4; ++corner) table.sides[corner] = {0.0, Drift::stays};
  table.sides[0].drift = table.sides[1].drift = Drift::up;  // surface 0 depends on 1
  EXPECT_EQ(parts_by_influence(table), (Parts{{0, 1}}));
}

}  // namespace
}  // namespace saltus::switching
