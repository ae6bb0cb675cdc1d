// A simulated solution at given times.
#pragma once

#include <vector>

#include "saltus/base/error.hpp"
#include "saltus/pipeline/options/simulate_options.hpp"
#include "saltus/pipeline/simulate.hpp"
#include "saltus/result/continuous.hpp"
#include "saltus/result/result.hpp"

namespace saltus::model {
struct System;
}

namespace saltus::pipeline {

using SideOfEvent = result::Side;

/// Evaluates x(t), inputs, outputs, selections and modes at any times of a simulation, from the method's dense output.
///
/// The simulation is run once more with rows at these times, and without branches: the values are those of its rows at
/// the same times bit for bit, and no polynomials are kept in memory. Who asks again and again has them kept
/// (SimulateOptions::continuous).
/// @param times  in any order, within [from, until], and not behind the end of a run that stops early
/// @return one row per time, in their order; an Error for a time that is NaN or outside, and for options that do not
///         fit. Cost: that of the simulation up to the last time, for all times together.
[[nodiscard]] Expected<result::Trajectory> values_at(const model::System& system, const SimulateOptions& options,
                                                     const std::vector<double>& times,
                                                     SideOfEvent side = SideOfEvent::behind,
                                                     const Observers& observers = {});

}  // namespace saltus::pipeline
