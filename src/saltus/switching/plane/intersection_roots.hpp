// Sliding on the intersection of two surfaces: the selections that keep both functions at zero.
#pragma once

#include <array>
#include <optional>

#include "saltus/switching/plane/plane_table.hpp"

namespace saltus::switching {

/// Holds a solution of g_1 = g_2 = 0, g_j(alpha_1, alpha_2) the bilinear interpolation of row j (eq. (4.6) of
/// [guglielmi2022]), with G_jp = d g_j / d alpha_p there: twice the matrix (4.7), which is by lambda = 2 alpha - 1.
struct SlidingRoot {
  PlaneAlpha alpha{};
  std::array<std::array<double, 2>, 2> sliding_jacobian{};
  double determinant = 0.0;

  /// Returns whether some scaling of the surfaces makes the root an attractor of the hidden dynamics:
  ///   det G > 0 and min(G11, G22) < 0   (eq. (4.12)).
  [[nodiscard]] bool stabilisable() const;
  /// Returns whether it is strictly inside the unit square.
  [[nodiscard]] bool inside() const;
};

/// Holds both solutions of g_1 = g_2 = 0, wherever they are (bilinear_root.hpp). They have opposite signs of det G:
///   rising: det G > 0, the only one that can be slid on;  falling: det G < 0.
struct IntersectionRoots {
  /// (det G)^2 at the roots over the squares of the Euclidean norms of the rows, a polynomial of the table; negative:
  /// no root; 0: double root.
  double discriminant = 0.0;
  std::optional<SlidingRoot> rising, falling;
};

/// Finds both roots. One that does not exist, or is at infinity, is missing. Evaluated without cancellation, polished
/// by a Newton step; near a double root the accuracy is the square root of rounding. Invariant under scaling of a row
/// by powers of two.
[[nodiscard]] IntersectionRoots intersection_roots(const PlaneTable& table);

}  // namespace saltus::switching
