// When two times are one.
#pragma once

#include <algorithm>
#include <cmath>

#include "saltus/base/rounding_unit.hpp"

namespace saltus {

/// Relative errors of sums of products of rounded numbers, in units of rounding.
inline constexpr double roundings_of_times = 4.0;

/// Returns what roundings leave of a time that is made of times up to `size`: of k periods behind a start, say, against
/// the number that somebody writes for it.
[[nodiscard]] inline double time_rounding(double size) { return roundings_of_times * rounding_unit * std::abs(size); }

/// Returns whether two times are equal but for rounding.
/// @param size  the largest time that they are made of, where that is larger: the start that periods are counted from
[[nodiscard]] inline bool is_same_time(double a, double b, double size = 0.0) {
  return a == b || std::abs(a - b) < time_rounding(std::max({std::abs(a), std::abs(b), std::abs(size)}));
}

}  // namespace saltus
