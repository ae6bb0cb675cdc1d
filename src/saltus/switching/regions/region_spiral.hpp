// Spirals around a point of the plane at which regions by indicator meet.
#pragma once

#include <optional>
#include <vector>

#include "saltus/switching/regions/tied_regions.hpp"

namespace saltus::switching {

/// Goes through all regions of a polygon in one cycle with constant fields. It begins on the border behind the last of
/// them at distance 1 (in s) from the point: with b_k the direction of the border in front of region k, and d_0 = 1,
///   d_{k-1} b_{k-1} + t_k r_k = d_k b_k.
/// All scales with the distance delta, as in SpiralCycle. For d_n > 1 a solution that leaves the point at (t, y) is at
/// y + delta sum_k t_k f_k at t + delta sum_k t_k. That is on the border on which cycles begin.
struct RegionCycle {
  std::vector<int> regions;       ///< in order, numbers in the tie
  std::vector<double> durations;  ///< t_k per unit of delta
  double cycle_ratio = 0.0;       ///< d_n

  [[nodiscard]] double duration() const;
};

/// Returns the cycle that begins with the region of the smallest number; nullopt if the fields of the regions do not
/// all turn in one sense, or the tie is not one of the plane.
[[nodiscard]] std::optional<RegionCycle> region_spiral(const RegionTie& tie);

}  // namespace saltus::switching
