// Errors of a simulation by a second one that is more accurate.
#pragma once

#include "saltus/base/error.hpp"
#include "saltus/base/function_ref.hpp"
#include "saltus/pipeline/options/simulate_options.hpp"
#include "saltus/result/result.hpp"

namespace saltus::pipeline {

/// Simulates with other options.
using SimulateAgain = FunctionRef<Expected<result::Result>(const SimulateOptions&)>;

/// Returns estimates of the errors of rows, events and end: differences to a second run. That has a hundredth of the
/// tolerances and of the width that is smoothed; with elements it has steps of a fifth. Rows at events are compared
/// with the same event. Fails where the second run does. Cost: that of the run times 3 to 6.
[[nodiscard]] Expected<result::ErrorEstimate> estimate_errors(const result::Result& result, SimulateOptions options,
                                                              const SimulateAgain& again);

}  // namespace saltus::pipeline
