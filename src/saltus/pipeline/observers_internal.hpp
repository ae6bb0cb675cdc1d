// Several runs for one observer.
#pragma once

#include "saltus/pipeline/simulate.hpp"

namespace saltus::pipeline {

/// Shows every run as one trajectory of so many, and remembers a stop.
class Numbered {
 public:
  /// The observers must outlive it.
  Numbered(const Observers& observers, long runs) : observers_(observers), runs_(runs) {}
  Numbered(const Numbered&) = delete;
  Numbered& operator=(const Numbered&) = delete;

  /// Returns observers of the next run; must not outlive this.
  [[nodiscard]] Observers next() {
    ++number_;
    Observers inner;
    if (!observers_.on_step) return inner;
    inner.on_step = [this, number = number_](StepRecord step) {
      step.trajectory = number;
      step.trajectories = runs_;
      const auto answer = observers_.on_step(step);
      stopped_ = stopped_ || answer == Proceed::stop;
      return answer;
    };
    return inner;
  }
  [[nodiscard]] bool stopped() const { return stopped_; }

 private:
  const Observers& observers_;
  long runs_;
  long number_ = 0;
  bool stopped_ = false;
};

}  // namespace saltus::pipeline
