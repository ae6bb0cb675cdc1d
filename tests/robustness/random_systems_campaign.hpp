// Many random systems, each simulated with every explicit integrator and checked.
#pragma once

#include <cstdint>

#include "random_systems.hpp"
#include "tally.hpp"

namespace saltus::robustness {

/// Systems first, first + 1, … of a family.
[[nodiscard]] Tally run_campaign(Family family, std::uint64_t first, std::uint64_t count);

/// So many seeds of each family from 0 on are in random_systems_test.cpp, those behind them in slow/.
inline constexpr std::uint64_t systems_of_short_campaign = 100;

}  // namespace saltus::robustness
