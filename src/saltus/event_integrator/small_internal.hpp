// What every source of this module needs of small things.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace saltus::event_integrator {

/// Relative spacing of doubles.
inline constexpr double rounding_unit = std::numeric_limits<double>::epsilon();

inline std::size_t at(int i) { return static_cast<std::size_t>(i); }

inline bool is_finite(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [](double value) { return std::isfinite(value); });
}

}  // namespace saltus::event_integrator
