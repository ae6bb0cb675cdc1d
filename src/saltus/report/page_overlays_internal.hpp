// What a page knows of the results laid over its own, as JSON.
#pragma once

#include <cstddef>
#include <vector>

#include "saltus/report/json_internal.hpp"
#include "saltus/report/overlay.hpp"

namespace saltus::report {

/// Returns their columns in the order of those of `first`, by name; an empty list for a column that they do not have.
/// @param limit  numbers to aim at for each; see rows_to_draw
[[nodiscard]] nlohmann::json overlays_data(const result::Result& first, const std::vector<Overlay>& overlays,
                                           std::size_t limit);

}  // namespace saltus::report
