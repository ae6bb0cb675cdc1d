// The usual sign change: a polynomial that falls once, at a simple zero.
#pragma once

#include <optional>

#include "saltus/ode/bernstein.hpp"

namespace saltus::ode {

/// A bracket, at most 2^-41 wide, of the zero in (0, 1) of a polynomial that has exactly one there and falls, b_0 > 0 >
/// b_8. Newton from the inverse quadratic through both ends and the middle; the signs on both sides are checked.
/// @return nullopt where a few steps do not get there (a multiple zero, values that are rounding errors)
/// Cost: about 200 floating-point operations, few of which wait for each other.
[[nodiscard]] std::optional<SignChange> only_zero(const BernsteinCoefficients& coefficients);

}  // namespace saltus::ode
