// Events so near to each other that rounding decides whether the modes between them were there.
#pragma once

#include <cstddef>
#include <vector>

#include "random_systems.hpp"
#include "saltus/result/result.hpp"

namespace saltus::robustness {

/// Whether the mode before the event `first`, or the one behind the event `second`, could as well have taken the time
/// between both: along its own field every listed psi keeps its side to the rounding of its terms and of t, and so it
/// does in the modes between. So it is where surfaces are touched (psi is 1e-20 beyond its zero), met together, or slid
/// on from the very point at which that ends. An event that is found twice leads to a mode that does not keep its
/// sides, or where that is not resolved either, as behind a tangential exit, happens twice.
[[nodiscard]] bool is_unresolved(const RandomSystem& system, const std::vector<bool>& listed,
                                 const result::Result& result, std::size_t first, std::size_t second);

}  // namespace saltus::robustness
