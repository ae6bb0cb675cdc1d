// What tests measure errors of rounding in.
#pragma once

#include <limits>

namespace saltus {

inline constexpr double epsilon = std::numeric_limits<double>::epsilon();

}  // namespace saltus
