// What an engine tells while it runs.
#pragma once

#include <functional>
#include <span>

namespace saltus::result {

/// Says, after accepted steps: how far it is.
struct Progress {
  double t = 0.0;
  long steps = 0;
  long events = 0;
  std::span<const double> x{};  ///< the state there, valid during the call; empty after a step that was divided
};

enum class Continue { yes, no };

/// `no` stops the run with `stopped_by_user`; an empty one is not asked.
using StepObserver = std::function<Continue(const Progress&)>;

}  // namespace saltus::result
