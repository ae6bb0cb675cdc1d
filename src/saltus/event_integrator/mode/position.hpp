// Where a run is: time, state, slope, mode, and the step that is proposed from there.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "saltus/base/same_time.hpp"
#include "saltus/event_integrator/mode/mode_change.hpp"
#include "saltus/event_integrator/mode/mode_state.hpp"

namespace saltus::event_integrator {

/// Holds one point of a run, which owns it; the parts of a run read it. Time and state go on by move_to() only, the
/// mode by change_mode() only; projections and jumps correct the state where it is.
struct Position {
  double t = 0.0;
  std::vector<double> x;
  std::vector<double> slope;  ///< f(t, x) in the mode
  ModeState state;
  double h = 0.0;           ///< the step that is proposed next
  double time_scale = 0.0;  ///< the last full step: the time over which second-order sign tests look ahead

  Position(double begin, std::vector<double> initial) : t(begin), x(std::move(initial)), slope(x.size()) {}

  /// Moves along a step, or to what an event or a limit leads to; new_x has n_x entries.
  void move_to(double new_t, const double* new_x) {
    t = new_t;
    std::copy_n(new_x, x.size(), x.begin());
  }
  void change_mode(const ModeState& next) { state = next; }
  void change_mode(const ModeChange& change) { apply(change, state); }
  void change_mode(const ModeChange& change, const Activities& activities) {
    apply(change, state);
    state.activities = activities;
  }

  /// Returns the smallest step that is still seen in t.
  [[nodiscard]] double smallest_step() const { return std::max(time_rounding(t), std::numeric_limits<double>::min()); }
};

}  // namespace saltus::event_integrator
