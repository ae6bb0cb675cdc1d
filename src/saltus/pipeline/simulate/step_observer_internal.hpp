// The pipeline's observers as an engine's.
#pragma once

#include "saltus/pipeline/simulate.hpp"
#include "saltus/result/progress.hpp"

namespace saltus::pipeline {

/// Holds a run, and which one of how many it is.
struct ObservedRun {
  double from = 0.0;
  double until = 0.0;
  long trajectory = 1;
  long trajectories = 1;
};

/// Returns an observer, empty if nobody observes. `observers` must outlive it.
[[nodiscard]] inline result::StepObserver step_observer(const Observers& observers, const ObservedRun& run) {
  if (!observers.on_step) return {};
  return [&observers, run](const result::Progress& progress) {
    const auto answer = observers.on_step({progress.t, run.from, run.until, progress.steps, progress.events,
                                           run.trajectory, run.trajectories, progress.x});
    return answer == Proceed::on ? result::Continue::yes : result::Continue::no;
  };
}

}  // namespace saltus::pipeline
