// The tables of `compare` and `order` for a terminal.
#pragma once

#include <string>

#include "saltus/result/result.hpp"

namespace saltus::report {

/// Writes one row for every run: end state, switches, difference from the reference, time; then why others were not
/// made.
[[nodiscard]] std::string comparison_table(const result::Result& result, const result::Comparison& comparison);

/// Writes d(end state): a row for every state, a column for every initial value and parameter; the first ones of many.
[[nodiscard]] std::string sensitivity_table(const result::Result& result, const result::Sensitivities& sensitivities);

/// Writes one row for every scheme: the errors over the mean steps, and the fitted slopes.
[[nodiscard]] std::string order_table(const result::Result& result, const result::OrderStudy& order);

}  // namespace saltus::report
