// When Newton's method has found its root.
#pragma once

#include <limits>

namespace saltus::switching {

/// Watches the steps of one search for a root of functions that are good to rounding level.
class NewtonSteps {
 public:
  struct Step {
    double size = 0.0;   ///< its largest component
    double reach = 0.0;  ///< the largest component of the point behind it
  };
  /// Returns whether the search ends with this step: it is of rounding size, or rounding has the last word as steps no
  /// longer shrink. Towards a double root they halve until they are as long as the distance to its twin, and square
  /// from there.
  [[nodiscard]] bool end_with(const Step& step) {
    constexpr double rounding = 4e-16;
    constexpr double settled = 1e-7;  // from here a step squares to rounding level
    if (step.size <= rounding * (1.0 + step.reach)) return true;
    const bool stalls = step.size <= settled && step.size > 0.7 * previous_;
    previous_ = step.size;
    return stalls;
  }

 private:
  double previous_ = std::numeric_limits<double>::infinity();
};

}  // namespace saltus::switching
