// Which of several starts is the answer.
#pragma once

#include "saltus/result/optimization.hpp"

namespace saltus::result {

/// Returns whether `a` is the answer rather than `b`: a completed one before others, then the lower objective; of
/// others the one that violates less.
[[nodiscard]] inline bool is_better(const StartOutcome& a, const StartOutcome& b) {
  const bool a_done = a.termination == Termination::completed, b_done = b.termination == Termination::completed;
  if (a_done != b_done) return a_done;
  return a_done ? a.objective < b.objective : a.infeasibility < b.infeasibility;
}

}  // namespace saltus::result
