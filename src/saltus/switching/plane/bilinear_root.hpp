// Sliding on two surfaces that influence each other: the selections as a smooth function of the fields.
#pragma once

#include <array>

namespace saltus::switching {

/// Normal components of the four fields at an intersection, (g_1, g_2) each; corner k1 + 2 k2 has the selections
/// alpha_j = k_j.
using PairCorners = std::array<std::array<double, 2>, 4>;

/// Says which of the two roots of g(alpha_1, alpha_2) = 0 is meant: that with det G > 0 or < 0, G_jp = d g_j / d
/// alpha_p. Only the first kind can attract; the other one is a solution where a mode is forced.
enum class RootKind { rising, falling };

/// Holds such a root.
struct BilinearRoot {
  std::array<double, 2> alpha{};      ///< not finite where the root is at infinity
  std::array<double, 2> from_one{};   ///< alpha - 1, relatively exact near 0
  std::array<double, 2> condition{};  ///< size of the terms that alpha_j is the quotient of: its rounding, over a unit
  std::array<std::array<double, 2>, 2> G{};  ///< at the root
  /// det G squared over the squares of the sizes of g_1, g_2: a polynomial of the fields, negative where there is no
  /// root.
  double discriminant = 0.0;
  /// > 0 where min(G_11, G_22) < 0, condition (4.12) of [guglielmi2022], which with det G > 0 says that some scaling
  /// makes the root stable; smooth, 0 where one of both vanishes and the other is positive.
  double stability = 0.0;
};

/// Finds the root of the quadratic P where it rises, or falls, for either selection. With g(s, .) affine, the product
/// P(s) = g(s, 0) x g(s, 1) vanishes where g(s, v) does for some v, and there P'(s) = det G. At the corners of the
/// square P is the product of two normal components less that of two others. alpha_j is that over a positive number: it
/// reaches a bound where they do, without cancellation. Where the two roots have coalesced and vanished (discriminant <
/// 0) the double root is continued, so that steps may look beyond. Invariant under scaling of a row. Cost: about 60
/// operations, one square root. [guglielmi2022], eq. (4.6).
[[nodiscard]] BilinearRoot bilinear_root(const PairCorners& g, RootKind kind);

/// Returns the selections to evaluate the field with: g(alpha) = 0 to the rounding u of its terms, as far as det G goes
/// to 0. Those of `root` are each known to u condition_j and leave as much of g. For G of rank one what both errors
/// leave is in the column space of G. There the smallest change of alpha that balances the longer row balances the
/// other one to u. Both rows count in their sizes. The same numbers as in `root` where their residual is below 1e-10, a
/// tenth of what selections may leave, and where there is no root. Cost: 40 operations where not.
[[nodiscard]] std::array<double, 2> balanced_selections(const PairCorners& g, const BilinearRoot& root);

}  // namespace saltus::switching
