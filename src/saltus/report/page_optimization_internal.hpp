// What the page of an optimisation shows beside its trajectory, as JSON.
#pragma once

#include <cstddef>

#include "saltus/report/json_internal.hpp"
#include "saltus/result/result.hpp"

namespace saltus::report {

/// Multipliers that a page holds at most.
inline constexpr std::size_t multipliers_in_page = 20000;

/// Returns null without an optimisation.
/// @param limit  numbers of the open-loop simulation to aim at; see rows_to_draw.
[[nodiscard]] nlohmann::json optimization_data(const result::Result& result, std::size_t limit);

}  // namespace saltus::report
