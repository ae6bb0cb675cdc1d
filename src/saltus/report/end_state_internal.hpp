// What the terminal shows of the end of a run.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "saltus/result/result.hpp"

namespace saltus::report {

/// Writes end state, what slides, regions, contacts and outputs: all, of many a summary; or what is named (to_table).
[[nodiscard]] std::string end_state(const result::Result& result, const std::vector<std::string>& names);

/// Returns the states that are named, by number.
[[nodiscard]] std::vector<std::size_t> shown_states(const result::Result& result,
                                                    const std::vector<std::string>& names);

}  // namespace saltus::report
