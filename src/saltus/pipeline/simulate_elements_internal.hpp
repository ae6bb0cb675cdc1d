// Simulation by finite elements, with switch detection and without.
#pragma once

#include "saltus/evaluation/model_kernel.hpp"
#include "saltus/pipeline/simulate.hpp"

namespace saltus::pipeline {

[[nodiscard]] evaluation::NativeCode native_code(Native native);

/// Simulates by fesd or timestepping: reformulates the system, integrates it, and fills the parts of `frame` that
/// depend on it. `times`: of the rows, empty for every element; `forced`: index into System::switching and mode.
[[nodiscard]] Expected<result::Result> simulate_elements(const model::System& system, const SimulateOptions& options,
                                                         std::vector<double> times,
                                                         std::vector<std::pair<int, int>> forced, result::Result frame,
                                                         const Observers& observers);

}  // namespace saltus::pipeline
