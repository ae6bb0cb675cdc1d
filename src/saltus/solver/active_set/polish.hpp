// From a nearly complementary point to one that is complementary to rounding.
#pragma once

#include "saltus/linalg/matrix.hpp"
#include "saltus/mpcc/residuals.hpp"

namespace saltus::solver::active_set {

/// Holds the equations that are left when every pair keeps the side that is zero: g = 0 for rows with equal bounds, G_i
/// = 0 or H_i = 0, both where the pair is biactive.
struct ActiveSystem {
  linalg::Vector residual;
  linalg::Matrix jacobian;  ///< residuals by variables
};
/// Evaluates them at w, for given sides (mpcc::active_sides); pairs with ActiveSide::none contribute nothing.
[[nodiscard]] ActiveSystem active_system(mpcc::Problem& problem, mpcc::ConstVectorView w,
                                         const std::vector<mpcc::ActiveSide>& sides, double negligible);

enum class PolishOutcome {
  polished,       ///< w satisfies everything to the tolerance
  no_active_set,  ///< some pair has no side that is nearly zero
  not_converged,  ///< no point with these active sides is near
  violated,       ///< there is one, but it violates bounds or signs: the sides are wrong
};

struct PolishOptions {
  /// What counts as zero at the start: a path that ends with G H <= 1e-9 can leave both sides of a biactive pair at
  /// 3e-5.
  double active = 1e-4;
  double tolerance = 1e-11;  ///< of all residuals afterwards, in the units of the problem
  int iterations = 20;
};

/// Takes Gauss-Newton steps of least norm on the active system, so that what it leaves undetermined stays where it is.
/// Biactive pairs are held at both sides first; if that has no solution, they are left out, and what they become
/// decides. `w` is changed only if the outcome is `polished`. The objective is not looked at: for problems whose
/// solutions are their feasible points with given active sides. Cost: per step a complete orthogonal factorisation of
/// the dense Jacobian.
[[nodiscard]] PolishOutcome polish(mpcc::Problem& problem, linalg::Vector& w, const PolishOptions& options = {});

}  // namespace saltus::solver::active_set
