// Regions by indicator that meet on a switching surface which influences them: which of them go on, on which side.
#pragma once

#include <vector>

#include "saltus/switching/regions/region_decision.hpp"

namespace saltus::switching {

/// Holds n regions with equal indicators on psi = 0, by the selection alpha of psi, in which all is affine.
struct RegionsOnSurface {
  RegionRates below, above;                            ///< of the fields at alpha = 0 and 1
  std::vector<double> velocity_below, velocity_above;  ///< n: d psi/dt along them
};

/// Holds a set of regions that stays on the surface, with its selection.
struct RegionSlide {
  RegionSet regions;  ///< its margin takes alpha and 1 - alpha in
  double alpha = 0.0;
};

/// Returns all sets that slide on the surface, for alpha in [0, 1]: of each subset I
///   w_i(alpha) = mu for i in I, sum_i theta_i = 1, psi' = sum_i v_i(alpha) theta_i = 0,
/// a pencil (A + alpha B) (theta, mu) = 0, whose real eigenvalues are the alpha. `attracts` is of the dynamics of
/// theta_i ~ exp(-g_i / eps) and alpha ~ 1 / (1 + exp(-psi / eps)) with psi in units in which it is as fast as the
/// indicators. Where the gradients of psi and of the indicators depend on each other there is no such system: alpha
/// then is a function of the theta that hangs on the scale of psi, and sets are found that mean nothing. Cost: an
/// eigenvalue problem of order |I| + 1 for each of the 2^n - 1 subsets; n <= 12.
[[nodiscard]] std::vector<RegionSlide> admissible_region_slides(const RegionsOnSurface& point, double tolerance);

/// Does the same for one set, the solution whose alpha is nearest to `near`; false if there is none.
[[nodiscard]] bool solve_region_slide(const RegionsOnSurface& point, const std::vector<int>& active, double near,
                                      RegionSlide& slide);

}  // namespace saltus::switching
