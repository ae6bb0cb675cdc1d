// Limits of doubles, as tests measure rounding in them.
#pragma once

#include <limits>

namespace saltus {

inline constexpr double epsilon = std::numeric_limits<double>::epsilon();
inline constexpr double infinity = std::numeric_limits<double>::infinity();

}  // namespace saltus
