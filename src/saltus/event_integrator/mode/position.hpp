// Where a run is: time, state, slope, mode, and the step that is proposed from there.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "saltus/base/rounding_unit.hpp"
#include "saltus/event_integrator/mode/mode_state.hpp"

namespace saltus::event_integrator {

/// A Position is one point of a run. The run owns one and changes it; its parts read it.
struct Position {
  double t = 0.0;
  std::vector<double> x;
  std::vector<double> slope;  ///< f(t, x) in the mode
  ModeState state;
  double h = 0.0;           ///< the step that is proposed next
  double time_scale = 0.0;  ///< the last full step: the time over which second-order sign tests look ahead

  Position(double begin, std::vector<double> initial) : t(begin), x(std::move(initial)), slope(x.size()) {}

  /// Returns the smallest step that is still seen in t.
  [[nodiscard]] double smallest_step() const {
    return std::max(4.0 * rounding_unit * std::abs(t), std::numeric_limits<double>::min());
  }
};

}  // namespace saltus::event_integrator
