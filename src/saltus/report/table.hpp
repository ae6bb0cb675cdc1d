// A result as a short readable table for a terminal.
#pragma once

#include <cstddef>
#include <string>

#include "saltus/result/caption.hpp"
#include "saltus/result/result.hpp"

namespace saltus::report {

/// How many events the table shows at each end of a long list.
inline constexpr std::size_t events_at_each_end = 10;

/// Method, status, end state, event list (the first and the last ones, with the count), statistics; of a comparison a
/// row for every run, of an order study one for every scheme.
[[nodiscard]] std::string to_table(const result::Result& result, std::size_t shown_events = events_at_each_end,
                                   const result::Captions& captions = {});

}  // namespace saltus::report
