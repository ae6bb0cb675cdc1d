// Model in, trajectory out.
#pragma once

#include <functional>

#include "saltus/base/error.hpp"
#include "saltus/model/system.hpp"
#include "saltus/pipeline/simulate_options.hpp"
#include "saltus/result/result.hpp"

namespace saltus::pipeline {

/// What an observer sees after every accepted step.
struct StepRecord {
  double t = 0.0;
  double from = 0.0;
  double until = 0.0;
  long steps = 0;
  long events = 0;
  long trajectory = 1;    ///< number of the one under way, from 1
  long trajectories = 1;  ///< that will be followed, as far as is known
};
enum class Proceed { on, stop };

struct Observers {
  std::function<Proceed(const StepRecord&)> on_step;  ///< may be empty; `stop` ends with stopped_by_user
};

/// Simulates a system with the chosen method; follows other admissible modes if asked to (EventOptions::trajectories).
/// @return the result whatever the numerics did (see Result::status); an Error only for options that do not fit the
///         system (unknown names in initial_mode, until not after from, a method that is not available).
[[nodiscard]] Expected<result::Result> simulate(const model::System& system, const SimulateOptions& options,
                                                const Observers& observers = {});

}  // namespace saltus::pipeline
