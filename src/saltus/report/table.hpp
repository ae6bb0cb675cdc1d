// A result as a short readable table for a terminal.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "saltus/base/error.hpp"
#include "saltus/result/result.hpp"

namespace saltus::report {

/// How many events the table shows at each end of a long list.
inline constexpr std::size_t events_at_each_end = 10;

/// Writes method, status, end state, event list (the first and the last ones, with the count), statistics; of a
/// comparison a row for every run, of an order study one for every scheme.
/// @param names  states, outputs and switching functions whose end values are shown, as names or patterns (v*); none:
///               all, of a large system a summary. Values of a few states stand beside the events.
[[nodiscard]] std::string to_table(const result::Result& result, std::size_t shown_events = events_at_each_end,
                                   const std::vector<std::string>& names = {});

/// Checks whether there is something to show by each of these names; else an Error with the nearest ones.
[[nodiscard]] Expected<void> check_names(const std::vector<std::string>& names, const std::vector<std::string>& states,
                                         const std::vector<std::string>& outputs,
                                         const std::vector<std::string>& switching_functions);

}  // namespace saltus::report
