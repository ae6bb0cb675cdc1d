// The event-driven engine: from an initial state through all switches and sliding phases to the end.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "saltus/evaluation/model_kernel.hpp"
#include "saltus/event_integrator/choices.hpp"
#include "saltus/event_integrator/options.hpp"
#include "saltus/result/result.hpp"

namespace saltus::event_integrator {

struct Pieces;

/// Holds the parts of a result that an engine computes; `final` is the last row.
struct Integration {
  result::Status status;
  result::Final final;
  result::Events events;
  result::Trajectory trajectory;
  result::Statistics statistics;           ///< wall_seconds is left to the caller
  std::vector<BranchPoint> branch_points;  ///< events with alternatives behind the last choice, ascending
  bool chosen = true;                      ///< false: it stopped before the last choice, and begins at its own start
  std::vector<result::Family> families{};
  std::vector<long> family_numbers{};      ///< in the run: what a Choice of one names
  std::shared_ptr<const Pieces> pieces{};  ///< of its Solution, if asked for
};

/// Takes rows and events, in their order, while a run goes on.
using TakeRecorded = std::function<void(result::Trajectory, result::Events)>;

/// Integrates xdot in F(t, x) by classical and sliding motion, mode by mode ([guglielmi2022], sections 3, 4.1, 4.2).
///
/// Between events the order is that of the method. A switch is found on the dense output. Then the step is retaken to
/// exactly that time and corrected until the event function is at rounding level. With choices it is the same run up to
/// the last of them, with everything that waits, is held or was seen there. It goes on in the chosen mode, and has that
/// event with its two rows first.
/// @param take  gets all rows and events, of which the result then has none; memory does not grow with their number
///              (but by 8 bytes for each event). May be empty. Not together with choices.
/// @return everything computed up to the termination; never throws for numerical reasons. Independent of the output
///         times bit for bit.
/// Cost: evaluations of f (m + 1 or m + 2 per evaluation while sliding on m surfaces), 9 of the event functions a step.
[[nodiscard]] Integration integrate(evaluation::ModelKernel& kernel, const IntegrationOptions& options,
                                    const StepObserver& observer = {}, const TakeRecorded& take = {});

}  // namespace saltus::event_integrator
