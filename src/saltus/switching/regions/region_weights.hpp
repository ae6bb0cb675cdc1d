// Weights of regions by indicator that meet where their indicators depend on each other: the limit of soft minima.
#pragma once

#include <vector>

#include "saltus/linalg/factors.hpp"
#include "saltus/linalg/matrix.hpp"
#include "saltus/switching/regions/region_polytope.hpp"

namespace saltus::switching {

/// Finds weights where n regions meet and g_r - g_i = sum_k y_ik s_k with m < n - 1 independent s_k. The m equations
/// that keep them equal leave a polytope of weights. The weights theta_i ~ exp(-g_i / epsilon) have, for every epsilon,
///   theta_i = exp(y_i . v) / sum_j exp(y_j . v),   v = s / epsilon in R^m,
/// and the limit is the one of these with
///   sum_j theta_j r_j = 0,   r_j in R^m = ds/dt along the field of region j.
/// For four quadrants these are the products of the selections of two surfaces ([guglielmi2022]'s bilinear ones).
///
/// In p_k = exp(nu_k . v), nu_k the inward normals of m facets through a vertex a of the polytope, theta_i / theta_a =
/// prod_k p_k^(height of y_i over facet k): exponents 0 or at least 1, so that the equations are smooth where weights
/// vanish, p_k = 0, and have a continuation behind that.
/// Owns its work space.
class RegionWeights {
 public:
  explicit RegionWeights(RegionPolytope polytope);

  [[nodiscard]] RegionPolytope& polytope() { return polytope_; }
  [[nodiscard]] const RegionPolytope& polytope() const { return polytope_; }

  /// Applies Newton's method from nearby weights.
  /// @param rates  m x n, the r_j as columns
  /// @param theta  n, in: the start, which also says which facets are near; out: the root, outside of the simplex
  ///               behind an exit
  /// @return false if there is no root near by. Several starts may have several roots.
  /// Cost: per iteration n m powers and one linear system of order m; 2 to 4 iterations from nearby.
  [[nodiscard]] bool solve(const linalg::Matrix& rates, double* theta);

  /// Returns, behind solve(), the sum of the weights that are not on a facet: > 0 inside, and 0 where the solution
  /// leaves the other regions.
  [[nodiscard]] double excess(std::size_t facet) const { return excess_[facet]; }
  /// Returns, behind solve(), the determinant of the equations, rows over their lengths, which vanishes where two roots
  /// coalesce. Its sign is (-1)^m where the weights return to the root (m <= 2: only there, if the trace allows).
  [[nodiscard]] double determinant() const { return determinant_; }
  /// Returns, behind solve(), a number > 0 while the weights are stable: of a parallelepiped, whose weights are
  /// products of selections, for some scaling of these, as for that many switching functions (fisher_fuller_margin); of
  /// a polygon as they are. Passes 0 where that ends, other than by a determinant() of 0. LIMIT: other polytopes of
  /// dimension 3 and more always have 1. Cost: a product of matrices of order m; allocates for m > 2.
  [[nodiscard]] double stability() const;

 private:
  void choose_chart(const double* theta);
  void place_start(const double* theta);
  void evaluate(const linalg::Matrix& rates);
  [[nodiscard]] bool iterate(const linalg::Matrix& rates);
  void finish(const linalg::Matrix& rates, double* theta);

  RegionPolytope polytope_;
  std::vector<double> excess_;
  std::vector<std::size_t> order_;
  std::vector<std::size_t> chart_;  ///< m facets through a vertex
  bool is_box_ = false;             ///< all corners of a parallelepiped
  linalg::Matrix exponents_;        ///< n x m
  linalg::Vector p_, value_, step_, monomials_;
  linalg::Matrix slopes_;          ///< n x m: derivatives of the monomials
  linalg::Matrix jacobian_;        ///< m x m
  linalg::Matrix basis_, matrix_;  ///< work, m x m
  linalg::Lu factors_;             ///< work
  double determinant_ = 0.0;
};

/// Returns d (ds/dt) / dv at weights theta: its eigenvalues say whether the weights return, R (diag theta - theta
/// theta^T) Y.
[[nodiscard]] linalg::Matrix weight_dynamics(linalg::ConstView points, linalg::ConstView rates,
                                             linalg::ConstView theta);

}  // namespace saltus::switching
