// Simulations of systems with contacts and hysteresis by finite elements: their time stands still there.
#pragma once

#include <vector>

#include "saltus/base/error.hpp"
#include "saltus/pipeline/options/simulate_options.hpp"
#include "saltus/pipeline/simulate.hpp"
#include "saltus/result/result.hpp"

namespace saltus::model {
struct System;
}

namespace saltus::pipeline {

/// Integrates the frozen form until its clock shows `until`.
/// @param frame  the result without the run, of the system itself
/// @return the result in physical time, or why the system cannot be frozen
[[nodiscard]] Expected<result::Result> simulate_frozen(const model::System& system, const SimulateOptions& options,
                                                       std::vector<double> times, result::Result frame,
                                                       const Observers& observers);

}  // namespace saltus::pipeline
