// Many sliding surfaces of which each depends on few others: their parts, and what ends sliding on each.
#pragma once

#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include "saltus/linalg/sparse.hpp"
#include "saltus/switching/hidden/group_modes.hpp"
#include "saltus/switching/sparse/influence.hpp"
#include "saltus/switching/sparse/sparse_newton.hpp"

namespace saltus::event_integrator {

/// Returns whether so many surfaces that are connected by influence are decided and slid on by their parts: those whose
/// modes are not enumerated.
[[nodiscard]] constexpr bool is_large(std::size_t surfaces) {
  return surfaces > static_cast<std::size_t>(switching::largest_enumerated);
}

struct LargeGroup {
  std::vector<std::size_t> rows;  ///< of the sliding surfaces
  std::vector<std::vector<int>>
      parts;  ///< places in `rows`: those that depend on each other, in the order of influence
  std::unique_ptr<switching::SparseNewton> newton;
};

/// Returns two numbers of several surfaces that depend on each other, from the G of their group. The first keeps its
/// sign while their root exists (det G in the size of its rows, its root of the number of surfaces). The second is
/// positive while some scaling is known that makes the root stable, that of the certificate first.
[[nodiscard]] std::pair<double, double> loss_and_stability(const linalg::SparseColumns& effects,
                                                           const std::vector<int>& part);

}  // namespace saltus::event_integrator
