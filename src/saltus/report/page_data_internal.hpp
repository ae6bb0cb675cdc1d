// What the page of a report shows, as JSON.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "saltus/report/html.hpp"
#include "saltus/report/json_internal.hpp"
#include "saltus/result/result.hpp"

namespace saltus::report {

/// Numbers of the trajectory that a page holds at most (about 18 characters each); a longer one is thinned. As many for
/// the values of all events.
inline constexpr std::size_t numbers_in_page = 1500000;
/// States, controls, switching functions and outputs that a page holds at most of each: more than anybody chooses from.
inline constexpr std::size_t columns_in_page = 2000;
/// Values of every sort that an event keeps however many events there are.
inline constexpr std::size_t least_values_of_event = 4;

template <class T>
[[nodiscard]] nlohmann::json or_null(const std::optional<T>& value) {
  return value ? nlohmann::json(*value) : nlohmann::json(nullptr);
}

/// Returns the result column by column, modes as intervals; non-finite numbers become null when written.
/// @param limit  numbers of the trajectory to aim at; see rows_to_draw.
/// @param go_on  false ends it, with a part of the events
[[nodiscard]] nlohmann::json page_data(const result::Result& result, std::size_t limit = numbers_in_page,
                                       const GoOn& go_on = {});

/// Writes the JSON text in a form that can stand inside a <script> element whatever its strings contain.
[[nodiscard]] std::string to_script_text(const nlohmann::json& data);

}  // namespace saltus::report
