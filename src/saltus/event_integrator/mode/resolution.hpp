// What is told from rounding, and how far ahead a mode is looked at: each threshold in one place.
#pragma once

#include "saltus/base/rounding_unit.hpp"

namespace saltus::event_integrator {

/// Returns the rounding of a value whose terms are of this size: eight units in their last place.
constexpr double rounding_of(double terms) { return 8.0 * rounding_unit * terms; }

/// Returns what a function whose terms are of this size jumps by at least where it is not continuous: four digits above
/// rounding. A kink leaves rounding, a jump something of size.
constexpr double smallest_jump(double terms) { return 1e5 * rounding_unit * terms; }

/// Returns how much later a mode is looked at along its own motion, where no derivative decides.
constexpr double look_ahead(double time_scale) { return 1e-2 * time_scale; }

/// Holds how far beyond its bounds the selection of what was slid on may be at an exit: one that is located to rounding
/// leaves it there only to the conditioning of a quotient.
inline constexpr double selection_rounding = 1e-9;

/// Holds how close selections of two motions are that are one: they are carried along to about 1e-8.
inline constexpr double same_selection = 1e-6;

/// Holds the part of an effect below which it is none: what is left where velocities, good to ten digits, cancel.
inline constexpr double no_effect = 1e-9;

/// Holds the part of a size that doubles carry of it several hundred times.
inline constexpr double carried_part = 1e-13;

/// Returns whether a selection lies within its bounds, to rounding.
constexpr bool is_within_bounds(double selection) {
  return selection >= -selection_rounding && selection <= 1.0 + selection_rounding;
}

}  // namespace saltus::event_integrator
