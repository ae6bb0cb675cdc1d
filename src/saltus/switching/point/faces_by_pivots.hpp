// The faces of a point problem by complementary pivots.
#pragma once

#include <optional>
#include <vector>

#include "saltus/switching/point/point_problem.hpp"

namespace saltus::switching {

/// Returns faces that hold, or nearly, by complementary pivots; nothing where these end on a ray. Cones of two tangents
/// are taken for two of one each.
[[nodiscard]] std::optional<std::vector<Face>> faces_by_pivots(const PointProblem& problem,
                                                               const std::vector<std::vector<Face>>& options);

}  // namespace saltus::switching
