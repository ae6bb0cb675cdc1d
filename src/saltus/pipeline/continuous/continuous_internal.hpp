// Solutions as functions of time, of each engine.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "saltus/evaluation/model_kernel.hpp"
#include "saltus/event_integrator/integrate.hpp"
#include "saltus/fesd_integrator/solution.hpp"
#include "saltus/pipeline/options/simulate_options.hpp"
#include "saltus/result/continuous.hpp"

namespace saltus::model {
struct System;
}

namespace saltus::pipeline {

/// Holds what the event engine has run, with what keeps it alive.
struct EventRun {
  std::shared_ptr<const model::System> system;
  event_integrator::IntegrationOptions options;  ///< with the choices of a branch
  evaluation::NativeCode native = evaluation::NativeCode::off;
  std::function<void(result::Trajectory&)> restate{};  ///< rows, if they are those of a regularisation
};

/// Makes the solution between rows from the steps of a run.
/// @param kernel  that it was run with
[[nodiscard]] std::shared_ptr<result::Continuous> continuous(const result::Trajectory& rows, EventRun run,
                                                             const evaluation::ModelKernel& kernel,
                                                             std::shared_ptr<const event_integrator::Pieces> pieces);

/// Makes it of any other run.
/// @param solution  of elements, in a run without a clock; null: it is simulated once more for each call
[[nodiscard]] std::shared_ptr<result::Continuous> continuous(const result::Trajectory& rows,
                                                             const model::System& system,
                                                             const SimulateOptions& options,
                                                             std::shared_ptr<fesd_integrator::Solution> solution);

/// Makes it of an optimised point: of its elements with their slopes.
/// @param columns  leaves those of the user, of rows with all
[[nodiscard]] std::shared_ptr<result::Continuous> continuous(const result::Trajectory& rows,
                                                             std::shared_ptr<fesd_integrator::Solution> solution,
                                                             std::function<void(result::Trajectory&)> columns);

}  // namespace saltus::pipeline
