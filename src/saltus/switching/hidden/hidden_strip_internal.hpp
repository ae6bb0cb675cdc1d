// The hidden dynamics in closed form where one selection varies and the others are saturated.
#pragma once

#include <optional>

namespace saltus::switching {

/// Follows the free component, which obeys x' = v0 + rate (x - x0), x(0) = x0; a saturated one w' = velocity + slope (x
/// - x0).
struct StripMotion {
  double x0 = 0.0;
  double v0 = 0.0;
  double rate = 0.0;

  [[nodiscard]] double position(double t) const;              ///< x(t)
  [[nodiscard]] double integrated_excursion(double t) const;  ///< integral of x - x0 over [0, t]
  /// Returns when x = `target`, which lies in the direction of v0; nothing if x tends to a value before it.
  [[nodiscard]] std::optional<double> time_to(double target) const;
};

struct SaturatedMotion {
  double distance = 0.0;  ///< y(0) <= 0: how far beyond the boundary, negative outside
  double velocity = 0.0;  ///< y'(0), positive towards the boundary
  double slope = 0.0;     ///< d y' / d x
};

/// Returns the first t in (0, end] at which y, y' = velocity + slope (x - x0), passes from y <= 0 to y > 0; `end` may
/// be infinite, where x tends to x_end. y' changes sign at most once, so that the answer is certain.
[[nodiscard]] std::optional<double> time_of_return(const StripMotion& motion, const SaturatedMotion& saturated,
                                                   double end, double x_end);

}  // namespace saltus::switching
