// Roots of switching functions in the right-hand side, such as sqrt(abs(psi)): on the surface they are 0.
#pragma once

#include <vector>

#include <casadi/core/sx.hpp>

#include "saltus/evaluation/affine_functions_internal.hpp"

namespace saltus::evaluation {

/// Holds a right-hand side whose roots are 0 where their arguments are no more than rounding.
struct RootLimits {
  casadi::SX f;
  std::vector<bool> rooted;     ///< n_psi: whether a root of something that is 0 with psi_j was found in f
  std::vector<bool> continued;  ///< n_psi: and whether it is 0 beyond the surface of its region
  bool by_values = false;       ///< f has roots: what became of them may depend on the values of parameters
};

/// Replaces sqrt(e) and e^q, q > 0 no integer, by
///   0 where |e| <= 8 u (sum_i |d_i e x_i| + |d_t e t|), itself elsewhere (NaN where e < 0),
/// if e is 0, by its form, wherever one of psi is: +-psi_j, its products, and selections of these.
/// On a surface psi is rounding: 1e-16, of which the root is 1e-8, or NaN. Derivatives of the result are there those of
/// everything else, along the surface.
/// Selections are held while a step looks beyond the surface of its region, where abs(psi) is negative. If d psi/dt
/// jumps on the surface, and is not always 0 on one side, the root is 0 there, too: the field goes on as it is on the
/// surface, and steps get there (friction). Elsewhere what matters is psi relative to itself (super-twisting; a tank
/// that empties with its rate), and no step may pass it: NaN stops them.
/// @param psi         n_psi switching functions
/// @param parameters  values of the first entries of symbols.p, those that do not change: what is a multiple of psi_j
///                    is found by values
/// Cost: one pass over the operations of f, with a value of each at three points; where f has no such operation, one
/// look at each.
[[nodiscard]] RootLimits limit_roots(const casadi::SX& f, const casadi::SX& psi, const ModelSymbols& symbols,
                                     const std::vector<double>& parameters);

}  // namespace saltus::evaluation
