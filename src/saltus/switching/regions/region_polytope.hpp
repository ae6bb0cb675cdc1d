// Regions by indicator that meet at a point, as points: which of them can meet near by is a face of their convex hull.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "saltus/linalg/matrix.hpp"

namespace saltus::switching {

/// Sets of regions as bits.
using RegionBits = unsigned;

/// Holds n regions with equal indicators at a point, as points y_i of R^m (rows; m = independent differences of
/// indicators):
///   g_r - g_i = sum_k y_ik s_k   to first order, with independent s_k.
/// The regions that stay at the minimum along a direction s are those with the largest y_i . s: a face of the hull.
/// n <= 12.
class RegionPolytope {
 public:
  /// Returns nullopt if the points do not span R^m.
  [[nodiscard]] static std::optional<RegionPolytope> make(linalg::Matrix points);

  [[nodiscard]] const linalg::Matrix& points() const { return points_; }
  [[nodiscard]] int regions() const { return static_cast<int>(points_.rows()); }
  [[nodiscard]] int dimension() const { return static_cast<int>(points_.cols()); }
  /// Returns the faces of dimension m - 1, in an order that depends on the numbering of the regions only.
  [[nodiscard]] const std::vector<RegionBits>& facets() const { return facets_; }
  /// Returns the distances of the points from a facet, the smallest one that is not 0 being 1; facets in rows.
  [[nodiscard]] const linalg::Matrix& heights() const { return heights_; }
  /// Returns the inward normals with these heights: nu_f . (y_i - y) for y on facet f; facets in rows.
  [[nodiscard]] const linalg::Matrix& normals() const { return normals_; }
  /// Returns all faces but the empty one, the polytope itself first.
  [[nodiscard]] std::vector<RegionBits> faces() const;
  /// Takes other points with the same faces, as where gradients turn a little while the solution slides. Allocates
  /// nothing.
  void move(linalg::ConstView points);

 private:
  explicit RegionPolytope(linalg::Matrix points) : points_(std::move(points)) {}
  [[nodiscard]] bool find_facets();
  void set_facet(std::size_t facet);

  linalg::Matrix points_;
  std::vector<RegionBits> facets_;
  std::vector<std::vector<int>> spanning_;  ///< m regions of each facet whose points span it
  linalg::Matrix heights_, normals_;
  linalg::Matrix edges_;  ///< work
};

}  // namespace saltus::switching
