// The selections of sliding on several surfaces, followed from nearby values.
#pragma once

#include <span>
#include <vector>

#include "saltus/switching/table/matrix_stability.hpp"
#include "saltus/switching/table/multi_affine.hpp"
#include "saltus/switching/table/projected_field.hpp"

namespace saltus::switching {

/// Applies Newton's method to g(alpha) = 0, eq. (4.6) of [guglielmi2022] for any number m of surfaces: the selections
/// of sliding on all of them, from the ones a moment ago. Does not allocate after construction for m <= 2, nor in
/// solve().
class SelectionNewton {
 public:
  explicit SelectionNewton(int surfaces, Interpolation interpolation = Interpolation::multi_affine);

  /// Finds the root from a start.
  /// @param alpha  m doubles: the start; afterwards the root to rounding level, or where the iteration stopped. The
  ///               root may lie outside the cube: that is for the caller to see (an event function needs it).
  /// @return false if G becomes singular or the iteration does not settle within 30 steps (a double root close by)
  /// Cost: m + 1 evaluations of g per iteration, quadratic convergence: 2 to 4 iterations from nearby.
  bool solve(ProjectedField g, double* alpha);

  /// Returns G at the last point where it was formed: one Newton step before the root, at rounding distance; m x m.
  [[nodiscard]] std::span<const double> jacobian() const { return jacobian_; }
  [[nodiscard]] double determinant() const { return lu_.determinant(); }  ///< of the same G
  /// Returns fisher_fuller_margin of the same G: sliding persists for some scaling of the surfaces while it is
  /// positive.
  [[nodiscard]] double margin() const { return fisher_fuller_margin(jacobian_, surfaces_); }
  [[nodiscard]] long evaluations() const { return evaluations_; }  ///< of g, since construction

 private:
  int surfaces_;
  Interpolation interpolation_;
  long evaluations_ = 0;
  LuFactors lu_;
  std::vector<double> g_, step_, jacobian_, shifted_;
};

}  // namespace saltus::switching
