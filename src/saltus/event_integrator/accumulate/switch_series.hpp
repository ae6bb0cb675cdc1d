// The budget of switches: ends accumulations and chattering that no rule resolves.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "saltus/event_integrator/mode/mode_change.hpp"
#include "saltus/event_integrator/mode/small_internal.hpp"

namespace saltus::event_integrator {

/// Watches the switches of a run. Spirals into an intersection of surfaces and Zeno sequences have infinitely many in
/// finite time; in doubles they end in a loop of modes at one time.
class SwitchSeries {
 public:
  /// Begins without switches.
  /// @param span  of the whole run, in units of time
  explicit SwitchSeries(double span) : span_(span) {}

  /// Notes a change at t. There and back once is no loop: a surface may be touched more shallowly than time resolves.
  /// Cost: O(1) of one surface later than any change noted so far.
  /// @return whether the same change was made at this very time already: a loop
  bool note(double t, const ModeChange& change);
  /// Forgets what has changed at this time: behind a limit of switches the same change is none of a loop.
  void begin_anew() {
    changes_.clear();
    surface_change_.reset();
  }
  /// Returns the time of the last change noted.
  [[nodiscard]] double last() const { return last_; }
  /// Counts an event at t; whether there were too many in too short a time.
  [[nodiscard]] bool too_dense(double t);
  /// Returns whether the switches before t have followed each other ever faster, down to a scale on which no model
  /// lives: a run that cannot go on there has come to their limit.
  [[nodiscard]] bool shrinks(double t) const;
  /// Returns whether the last switches have followed each other faster than those before, over cycles of one to four;
  /// or a little faster, until cycles of four were half as long as when that began.
  [[nodiscard]] bool tightens() const;

 private:
  using Change = std::pair<std::vector<int>, std::vector<int>>;
  bool is_loop(const std::vector<int>& before, const std::vector<int>& after);
  void remember(double t);
  double span_;
  double last_ = 0.0;
  ReusedList<Change> changes_;  ///< those at last_
  /// The only change at last_, by its surface and the mode of that before: the mode behind it is the one that the next
  /// change comes from.
  std::optional<std::pair<std::size_t, int>> surface_change_;
  /// Two cycles of up to four switches, and one to start from.
  static constexpr std::size_t remembered = 9;
  std::array<double, remembered> times_{};  ///< of the last switches, the last one first
  std::size_t switches_ = 0;
  double first_cycle_ = 0.0;  ///< of four switches, before cycles began to shrink; 0 if they do not
  long in_a_row_ = 0;         ///< without the time having advanced noticeably
  double start_ = 0.0;
};

}  // namespace saltus::event_integrator
