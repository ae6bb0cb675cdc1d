// What roundings are measured in.
#pragma once

#include <limits>

namespace saltus {

/// Relative spacing of doubles.
inline constexpr double rounding_unit = std::numeric_limits<double>::epsilon();

}  // namespace saltus
