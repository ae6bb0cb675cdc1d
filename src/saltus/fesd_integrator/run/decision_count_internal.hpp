// Modes that follow each other at one time.
#pragma once

#include <utility>

namespace saltus::fesd_integrator {

/// Counts decisions at one time, and remembers one that found nothing.
class DecisionCount {
 public:
  /// Counts a decision at t; false if there have been too many: the modes change without end.
  [[nodiscard]] bool add(double t) {
    if (t_ != t) count_ = 0;
    t_ = t;
    return ++count_ <= most;
  }
  /// Returns whether elements of this length see something else than decisions, which look at what is just behind.
  [[nodiscard]] bool asks_for_shorter_elements() const { return count_ > most_at_one_length; }
  /// Leaves it open: no set was found to go on with, which is left to the fallback.
  void leave_open() { open_ = true; }
  [[nodiscard]] bool is_open() const { return open_; }
  /// Returns whether it was left open; it no longer is.
  [[nodiscard]] bool take_open() { return std::exchange(open_, false); }

 private:
  static constexpr int most = 20;
  static constexpr int most_at_one_length = 4;
  int count_ = 0;
  double t_ = 0.0;
  bool open_ = false;
};

}  // namespace saltus::fesd_integrator
