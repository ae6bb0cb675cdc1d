// What the steps of all methods check: finite values, and the scale of an error.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "saltus/ode/explicit/lanes_internal.hpp"
#include "saltus/ode/stepper.hpp"

namespace saltus::ode {

inline bool all_finite(const double* values, std::size_t n) {
  // A carry out of an exponent of ones only, into the sign's place: unlike comparisons, this loop vectorises
  // everywhere.
  constexpr std::uint64_t exponent = 0x7ff0'0000'0000'0000;
  constexpr std::uint64_t lowest_bit = 0x0010'0000'0000'0000;
  std::uint64_t carries = 0;
  for (std::size_t i = 0; i < n; ++i) carries |= (std::bit_cast<std::uint64_t>(values[i]) & exponent) + lowest_bit;
  return (carries >> 63) == 0;
}

/// Returns what an error of a component, or of a pair of them, is measured in.
template <class Value>
inline Value error_scale(const Tolerances& tolerances, Value x, Value x_new) {
  // A component that is 0 on both sides with atol = 0 has no scale: its error is 0 or far too large, but 0 / 0 is
  // not.
  const Value scale = tolerances.atol + tolerances.rtol * larger(absolute(x), absolute(x_new));
  return larger(scale, Value{} + std::numeric_limits<double>::min());
}

}  // namespace saltus::ode
