// The usual sign change: a polynomial that falls once, at a simple zero.
#pragma once

#include <optional>

#include "saltus/ode/bernstein.hpp"

namespace saltus::ode {

/// Half the width of the bracket.
inline constexpr double half_width_of_zero = 0x1p-42;

/// Returns where the inverse quadratic through the values at 0, 1/2 and 1 is 0.
inline double zero_of_inverse_quadratic(double at_start, double at_middle, double at_end) {
  const double share = at_start * at_end / ((at_middle - at_start) * (at_middle - at_end));
  const double rest = at_start * at_middle / ((at_end - at_start) * (at_end - at_middle));
  return 0.5 * share + rest;
}

/// Finds a bracket, at most 2^-41 wide, of the zero in (0, 1) of a polynomial that has exactly one there and falls, b_0
/// > 0 > b_8. Newton from the inverse quadratic through both ends and the middle; the signs on both sides are checked.
/// @return nullopt where a few steps do not get there (a multiple zero, values that are rounding errors)
/// Cost: about 200 floating-point operations, few of which wait for each other.
[[nodiscard]] std::optional<SignChange> only_zero(const BernsteinCoefficients& coefficients);

}  // namespace saltus::ode
