// The solution of a foreign MPCC as a short readable table for a terminal.
#pragma once

#include <string>

#include "saltus/result/mpcc_result.hpp"

namespace saltus::report {

/// Writes file, status, objective, residuals, the certificate in words, the path and the largest variables.
[[nodiscard]] std::string to_table(const result::MpccResult& result);

/// Writes one problem of a path on a line: phase, sigma, iterations, objective, infeasibility, min(|G|, |H|), seconds.
[[nodiscard]] std::string to_line(const result::HomotopyStep& step);
/// Returns a table of what came of several starts; empty for none.
[[nodiscard]] std::string starts_table(const std::vector<result::StartOutcome>& starts);

}  // namespace saltus::report
