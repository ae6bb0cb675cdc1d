// Many random systems, each simulated with every explicit integrator and checked.
#pragma once

#include <cstdint>

#include "random_systems.hpp"
#include "tally.hpp"

namespace saltus::robustness {

/// Systems first, first + 1, … of a family.
[[nodiscard]] Tally run_campaign(Family family, std::uint64_t first, std::uint64_t count);

}  // namespace saltus::robustness
