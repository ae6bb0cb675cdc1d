// The parts of the table of an optimisation that a simulation has not.
#pragma once

#include <string>

#include "saltus/result/result.hpp"

namespace saltus::report {

/// Writes "fesd (radau_iia, 2 stages, 20 intervals of 3 elements)".
[[nodiscard]] std::string optimization_method(const result::Result& result);
/// Writes objective with its terms, horizon, free parameters.
[[nodiscard]] std::string objective_table(const result::Optimization& optimization);
/// Writes what certificate and verification say.
[[nodiscard]] std::string findings_table(const result::Result& result, const result::Optimization& optimization);
/// Writes how many problems of which kind, what they cost.
[[nodiscard]] std::string optimization_statistics(const result::Optimization& optimization);

/// Writes tolerance of the residuals: the option in force, or its default.
[[nodiscard]] double residual_tolerance(const result::OptionRecord& options);

}  // namespace saltus::report
