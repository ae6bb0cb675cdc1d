// What happens where several surfaces that influence each other are met: the replaceable heart of the switching.
#pragma once

#include <cstddef>
#include <vector>

#include "saltus/switching/table/surface_decision.hpp"

namespace saltus::switching {

/// Holds the projected fields at a point of m surfaces: side(j, corner) is the normal component on surface j of the
/// field of `corner`, where bit i of the corner is the selection alpha_i in {0, 1} (2^m corners).
struct CornerTable {
  int surfaces = 0;
  std::vector<Arrival> arrival;  ///< m
  std::vector<Side> sides;       ///< m x 2^m, row by row

  [[nodiscard]] std::size_t corners() const { return std::size_t{1} << surfaces; }
  [[nodiscard]] const Side& side(int surface, std::size_t corner) const {
    return sides[static_cast<std::size_t>(surface) * corners() + corner];
  }
};

struct GroupDecision {
  Verdict verdict = Verdict::decided;
  int culprit = -1;                       ///< the surface that could not be decided, if any
  std::vector<SurfaceDecision> surfaces;  ///< m
};

/// Decides m surfaces (1 <= m <= 12) by elimination, which is exact where it applies:
///   (1) a surface whose normal component has one sign at all remaining corners is left in that direction;
///   (2) a surface whose normal component depends on its own selection only is decided by itself;
///   each decision restricts the table (multi-affine interpolation in a sliding selection) and the rest is looked at
///   again.
/// The hidden dynamics u_j' = g_j(pi(u)) confirms both: under (1) u_j leaves the cube monotonically, under (2) u_j does
/// not depend on the others. Where neither applies, or where a restricted surface turns out repelling so that the
/// transient would decide, the verdict is `coupled`. Cost: O(m^2 2^m).
[[nodiscard]] GroupDecision decide_group(const CornerTable& table);

/// Returns the parts of a group whose surfaces influence each other, in an order in which none depends on a later one:
/// numbers in the table, each part ascending. One part if every surface depends on every other, directly or through
/// others. A surface depends on a selection that changes its normal component, or where that leads if it is zero. Cost:
/// O(m^2 2^m).
[[nodiscard]] std::vector<std::vector<int>> parts_by_influence(const CornerTable& table);

}  // namespace saltus::switching
