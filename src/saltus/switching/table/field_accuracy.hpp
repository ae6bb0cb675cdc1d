// What projected fields are good to.
#pragma once

namespace saltus::switching {

/// Gradients and fields are good to twelve digits; what is less than this of its terms is 0.
inline constexpr double field_accuracy = 1e-9;

/// Relative size below which a difference of projected fields counts as rounding.
inline constexpr double field_rounding = 1e-12;

}  // namespace saltus::switching
