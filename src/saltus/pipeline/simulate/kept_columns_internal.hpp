// Columns that the rows of a result have.
#pragma once

#include <optional>

#include "saltus/base/error.hpp"
#include "saltus/pipeline/options/simulate_options.hpp"
#include "saltus/result/result.hpp"

namespace saltus::model {
struct System;
}

namespace saltus::pipeline {

/// Returns the columns with these names, or that fit a pattern (a name comes first: names of switching functions have
/// stars).
/// @param frame  a result with the names of its columns
/// @return nullopt if all are wanted; an Error that names what is not there, without a location
[[nodiscard]] Expected<std::optional<result::KeptColumns>> kept_columns(const result::Result& frame,
                                                                        const KeptNames& names);

/// Leaves the columns Result::kept of a result that has all, and of its branches; bodies are drawn before.
void keep_columns(const model::System& system, result::Result& result);

}  // namespace saltus::pipeline
