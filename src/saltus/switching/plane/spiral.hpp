// Spirals around the intersection of two surfaces: accumulation in closed form (section 4.4 of [guglielmi2022]).
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "saltus/switching/plane/plane_table.hpp"

namespace saltus::switching {

enum class Turning { counterclockwise, clockwise };  ///< in the plane of (psi_1, psi_2)

/// Returns the sense in which the four fields turn around the intersection, crossing each surface twice (signs (4.14),
/// or their mirror image); nullopt if they do not. Then there is exactly one sliding root, with det G > 0.
[[nodiscard]] std::optional<Turning> turning(const PlaneTable& table);

/// Holds one cycle with constant fields, which begins on a surface at distance 1 (in |psi|) from the intersection:
///   t_i = d_{i-1} / |f_in^{k_i}|,   d_i = t_i |f_out^{k_i}|,   d_0 = 1,   i = 1 .. 4
/// where in region k_i the component f_in leads to the next surface and f_out away from the last one. All scales with
/// the distance delta.
struct SpiralCycle {
  std::array<std::size_t, 4> corners{};  ///< the regions in order, as corners of the table
  std::array<double, 4> durations{};     ///< t_i per unit of delta; unit: time per unit of psi
  double cycle_ratio = 0.0;              ///< gamma = d_4 (eq. (4.15))

  /// Returns kappa of (6.3), the duration of the cycle per unit of delta. NOTE: the formula is misprinted there.
  [[nodiscard]] double duration() const { return (durations[0] + durations[1]) + (durations[2] + durations[3]); }

  /// For gamma > 1, a solution that leaves the intersection at (t, y): at t + delta duration() it is at
  /// y + delta sum_i durations[i] f^{corners[i]}, on the surface on which cycles begin, at distance delta (gamma - 1)
  /// (eq. (6.5)). delta > 0 is free: a family of solutions.
};

/// Returns the cycle that begins by entering the region `first` (a corner of the table).
[[nodiscard]] std::optional<SpiralCycle> spiral_cycle(const PlaneTable& table, std::size_t first);

}  // namespace saltus::switching
