// The fields that meet on the intersection of two switching surfaces, and what the sliding there depends on.
#pragma once

#include <array>
#include <cstddef>

#include "saltus/switching/table/group_decision.hpp"
#include "saltus/switching/table/surface_decision.hpp"

namespace saltus::switching {

/// Signs of (psi_1, psi_2), 0 = sliding, and the selections alpha in [0, 1].
using PlaneMode = std::array<int, 2>;
using PlaneAlpha = std::array<double, 2>;

/// Holds the normal components of four fields on two surfaces: side(j, corner), bit i of the corner is alpha_i. In the
/// notation of [guglielmi2022] f_j^{k1 k2} with corner 0 = (--), 1 = (+-), 2 = (-+), 3 = (++). The rows may be scaled
/// separately.
struct PlaneTable {
  std::array<std::array<Side, 4>, 2> sides{};

  [[nodiscard]] const Side& side(std::size_t surface, std::size_t corner) const { return sides[surface][corner]; }
  [[nodiscard]] double velocity(std::size_t surface, std::size_t corner) const {
    return sides[surface][corner].velocity;
  }
};

/// Makes the table from velocities alone; the drifts are their signs.
[[nodiscard]] PlaneTable plane_table(const std::array<std::array<double, 4>, 2>& velocities);

/// Makes the table from one of two surfaces.
[[nodiscard]] PlaneTable plane_table(const CornerTable& table);

}  // namespace saltus::switching
