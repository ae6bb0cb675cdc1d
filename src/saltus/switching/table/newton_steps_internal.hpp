// When Newton's method has found its root.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>

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

/// Applies Newton's method to selections that are followed from nearby; they may leave the cube, but not for long ways.
/// @param alpha      m doubles: the start; afterwards the root, or where it stopped
/// @param step       m doubles
/// @param find_step  finds the step at alpha; returns false where there is none
/// @return false where a step is not found, or 30 of them do not settle
template <class FindStep>
[[nodiscard]] bool follow_root(double* alpha, std::span<const double> step, FindStep&& find_step) {
  constexpr int iterations = 30;
  constexpr double astray = 1e3;
  NewtonSteps steps;
  for (int k = 0; k < iterations; ++k) {
    if (!find_step()) return false;
    double size = 0.0;
    double reach = 0.0;
    for (std::size_t j = 0; j < step.size(); ++j) {
      alpha[j] -= step[j];
      size = std::max(size, std::abs(step[j]));
      reach = std::max(reach, std::abs(alpha[j]));
    }
    if (!(reach < astray)) return false;
    if (steps.end_with({size, reach})) return true;
  }
  return false;
}

}  // namespace saltus::switching
