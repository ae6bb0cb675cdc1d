// The tables of `compare` and `order` for a terminal.
#pragma once

#include <string>

#include "saltus/result/result.hpp"

namespace saltus::report {

/// One row for every run: end state, switches, difference from the reference, time; then why others were not made.
[[nodiscard]] std::string comparison_table(const result::Result& result, const result::Comparison& comparison);

/// One row for every scheme: the errors over the mean steps, and the fitted slopes.
[[nodiscard]] std::string order_table(const result::Result& result, const result::OrderStudy& order);

}  // namespace saltus::report
