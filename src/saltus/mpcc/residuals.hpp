// How far a point is from being feasible, and which side of each pair is zero there.
#pragma once

#include <vector>

#include "saltus/mpcc/problem.hpp"

namespace saltus::mpcc {

/// Holds residuals, all in the units of the problem, unscaled; NaN if a function is not finite at the point.
struct Residuals {
  double primal_infeasibility = 0.0;      ///< largest violation of bounds of w and g, and of G >= 0, H >= 0
  double complementarity_residual = 0.0;  ///< max_i min(|G_i|, |H_i|)
  double complementarity_product = 0.0;   ///< max_i |G_i H_i|

  /// Returns the largest violation of anything: the larger of infeasibility and complementarity residual.
  [[nodiscard]] double infeasibility() const;
};

/// Cost: one evaluation of c.
[[nodiscard]] Residuals residuals(Problem& problem, ConstVectorView w);

/// Returns sides, one per pair; |value| <= tolerance counts as zero.
[[nodiscard]] std::vector<ActiveSide> active_sides(Problem& problem, ConstVectorView w, double tolerance);

}  // namespace saltus::mpcc
