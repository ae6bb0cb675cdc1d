// On which side of each surface the active ones of regions are that are sign patterns.
#pragma once

#include <vector>

#include "saltus/base/at.hpp"
#include "saltus/fesd_integrator/element/active_set.hpp"

namespace saltus::fesd_integrator {

/// Returns the sides of the surfaces of a simplex on which active regions are; 0 where these are on both, or none is
/// active.
template <class IsActive>
[[nodiscard]] std::vector<int> surface_modes(const Part& part, const IsActive& is_active) {
  std::vector<int> modes(at(part.surfaces), 0);
  bool first = true;
  for (int region = part.first; region < part.first + part.count; ++region) {
    if (!is_active(region)) continue;
    for (int surface = 0; surface < part.surfaces; ++surface) {
      const int side = part.side(region, surface);
      int& mode = modes[at(surface)];
      mode = first || mode == side ? side : 0;
    }
    first = false;
  }
  return modes;
}

}  // namespace saltus::fesd_integrator
