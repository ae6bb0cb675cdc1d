// The faces of a point problem by complementary pivots.
#pragma once

#include <optional>
#include <vector>

#include "saltus/switching/point/point_problem.hpp"

namespace saltus::switching {

/// Holds a vertex of the set of solutions.
struct PointVertex {
  std::vector<Face> faces;     ///< by block
  std::vector<bool> at_upper;  ///< by block: its normal part is at its upper bound, where y <= 0
  linalg::Vector z;
};

/// Returns faces that hold, or nearly, by complementary pivots; nothing where these end on a ray. Cones of two tangents
/// are taken for two of one each.
[[nodiscard]] std::optional<PointVertex> vertex_by_pivots(const PointProblem& problem,
                                                          const std::vector<std::vector<Face>>& options);

}  // namespace saltus::switching
