// The event engine's run before its events and rows are expanded into columns.
#pragma once

#include <memory>

#include "saltus/evaluation/model_kernel.hpp"
#include "saltus/event_integrator/options.hpp"
#include "saltus/event_integrator/record/pieces.hpp"
#include "saltus/event_integrator/record/recording.hpp"
#include "saltus/result/result.hpp"

namespace saltus::event_integrator {

/// Holds an Integration before events and rows are expanded into columns.
struct CompactIntegration {
  result::Status status;
  Recording recording;
  result::Statistics statistics;
  bool chosen = true;
  std::shared_ptr<const Pieces> pieces;  ///< if asked for
};

/// Does what integrate() does before it expands events and rows, which costs O(n_psi) for each of them: an event here
/// costs what it changes.
[[nodiscard]] CompactIntegration integrate_compact(evaluation::ModelKernel& kernel, const IntegrationOptions& options,
                                                   const StepObserver& observer = {});

}  // namespace saltus::event_integrator
