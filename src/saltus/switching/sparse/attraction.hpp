// A certificate for many surfaces that influence each other: one mode, which attracts whatever the scaling.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "saltus/linalg/sparse.hpp"
#include "saltus/switching/sparse/influence.hpp"
#include "saltus/switching/sparse/sparse_newton.hpp"
#include "saltus/switching/table/projected_field.hpp"

namespace saltus::switching {

/// Returns how much each surface depends on itself more than the others: C = diag(c) - |off-diagonal entries of G|, c_j
/// = -G_jj, its rows divided by c_j, and the least 1 / w_j of C w = 1. Where it is positive C is an M-matrix, and in
/// the norm max |u_j| / w_j the hidden dynamics u_j' = kappa_j g_j contracts for every kappa > 0: its root is unique
/// and attracts, and det G is not 0. It is positive wherever influence is one-way and every surface attracts by itself.
/// At most 1, and the same for all scalings of rows; 0 or less where the certificate fails.
/// @param comparison  C, m x m
[[nodiscard]] double attraction_margin(const linalg::SparseColumns& comparison);

/// Returns C of G at one point.
[[nodiscard]] linalg::SparseColumns comparison_of(const linalg::SparseColumns& effects);

/// Returns C with the least c_j and the largest other entries that multi-affine g has anywhere in the cube: those at
/// its corners. nullopt where there are more than `most_colours` colours. Cost: 2^colours evaluations of g.
[[nodiscard]] std::optional<linalg::SparseColumns> comparison_in_cube(const Influence& influence, ProjectedField g);
inline constexpr int most_colours = 8;

/// Holds a mode of all surfaces with its selections: g_j = 0 with alpha_j in (0, 1) where the mode is 0, else k_j g_j >
/// 0.
struct BoundedRoot {
  std::vector<int> mode;
  std::vector<double> alpha;
  bool is_borderline = false;  ///< a surface is tangent, or a selection at its bound, but for rounding
};

/// Returns the only one where `comparison` (C of the cube) has a positive margin: steps u := clip(u + g / c) contract
/// to it, and Newton's method on the selections that are not at their bounds gets there. nullopt if the margin is not
/// positive, or g is not finite.
/// @param start  m selections in [0, 1]
[[nodiscard]] std::optional<BoundedRoot> bounded_root(const Influence& influence, ProjectedField g,
                                                      const linalg::SparseColumns& comparison,
                                                      std::vector<double> start);

}  // namespace saltus::switching
