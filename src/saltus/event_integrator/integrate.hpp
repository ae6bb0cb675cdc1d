// The event-driven engine: from an initial state through all switches and sliding phases to the end.
#pragma once

#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "saltus/evaluation/model_kernel.hpp"
#include "saltus/event_integrator/choices.hpp"
#include "saltus/event_integrator/recording.hpp"
#include "saltus/model/system.hpp"
#include "saltus/ode/stepper.hpp"
#include "saltus/result/progress.hpp"
#include "saltus/result/result.hpp"
#include "saltus/switching/intersection.hpp"

namespace saltus::event_integrator {

/// Rows of the trajectory beside the two of every event and the last one.
struct OutputTimes {
  enum class Rows { at_times, at_steps };
  Rows rows = Rows::at_steps;
  std::vector<double> times;  ///< ascending, inside [from, until]; for at_times
  /// For at_steps: between the steps as many rows as keep straight lines within this part of the range of every state,
  /// input, output and selection, so far; 0: none.
  double straight = 0.0;
  std::size_t selections = 0;  ///< so many of the last outputs are selections, cut to [0, 1]
};

/// Layers of a regularised system: inside one, psi + half_width > 0 > psi - half_width.
struct ThinLayers {
  struct Corners {
    int lower = 0, upper = 0;  ///< switching functions psi + half_width and psi - half_width
  };
  std::vector<Corners> corners;
  double half_width = 0.0;
  /// Of soft minima: switching functions half_width (log theta_i) + weight_range, positive where a weight matters.
  std::vector<int> weights;
  double weight_range = 0.0;
  [[nodiscard]] bool empty() const { return corners.empty() && weights.empty(); }
};

/// Checked by the pipeline: from < until, rtol > 0, atol >= 0, max_step > 0.
struct IntegrationOptions {
  ode::Method method = ode::Method::dopri5;
  ode::Tolerances tolerances;
  double from = 0.0;
  double until = 1.0;
  std::optional<double> max_step;
  OutputTimes output;
  long max_steps = 1000000;
  long max_events = 100000;
  std::vector<std::pair<int, int>> initial_mode;  ///< switching function -> forced mode at the start
  /// Where the limit of regularised solutions depends on their scaling.
  switching::SelectionPolicy selection = switching::SelectionPolicy::active_dominant;
  std::vector<double> scaling;  ///< for SelectionPolicy::scaled: a factor per switching function; empty = ones
  /// Ascending: what to go on with instead of what is decided. The result begins at the last of these decisions.
  std::vector<Choice> choices;
  ThinLayers layers;  ///< inside them tolerances are tightened to what they bear
};

using result::Continue;
using result::Progress;
using result::StepObserver;

/// The parts of a result that an engine computes; `final` is the last row.
struct Integration {
  result::Status status;
  result::Final final;
  std::vector<result::Event> events;
  result::Trajectory trajectory;
  result::Statistics statistics;           ///< wall_seconds is left to the caller
  std::vector<BranchPoint> branch_points;  ///< events with alternatives behind the last choice, ascending
  bool chosen = true;                      ///< false: it stopped before the last choice, and begins at its own start
  std::vector<result::Family> families{};
  std::vector<long> family_numbers{};  ///< in the run: what a Choice of one names
};

/// The same before events and rows are expanded into columns.
struct CompactIntegration {
  result::Status status;
  Recording recording;
  result::Statistics statistics;
  bool chosen = true;
};

/// Integrates xdot in F(t, x) by classical and sliding motion, mode by mode ([guglielmi2022], sections 3, 4.1, 4.2).
///
/// Between events the order is that of the method: a switch is found on the dense output, then the step is retaken to
/// exactly that time and corrected until the event function is at rounding level.
/// With choices it is the same run up to the last of them, with everything that waits, is held or was seen there, goes
/// on in the chosen mode, and has that event with its two rows first.
/// @return everything computed up to the termination; never throws for numerical reasons. Independent of the output
///         times bit for bit.
/// Cost: evaluations of f (m + 1 or m + 2 per evaluation while sliding on m surfaces), 9 of the event functions a step.
[[nodiscard]] Integration integrate(const evaluation::ModelKernel& kernel, const model::System& system,
                                    const IntegrationOptions& options, const StepObserver& observer = {});

/// What integrate() does before it expands events and rows, which costs O(n_psi) for each of them: an event here costs
/// what it changes.
[[nodiscard]] CompactIntegration integrate_compact(const evaluation::ModelKernel& kernel, const model::System& system,
                                                   const IntegrationOptions& options,
                                                   const StepObserver& observer = {});

}  // namespace saltus::event_integrator
