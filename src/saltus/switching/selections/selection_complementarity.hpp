// The next mode where selections enter additively: surfaces that all are at zero, whose velocities are w + W lambda.
#pragma once

#include <vector>

#include "saltus/linalg/matrix.hpp"

namespace saltus::switching {

/// Holds a solution of: lambda in [0, 1]^m, y = w + W lambda, y_i > 0 only where lambda_i = 1, y_i < 0 only where
/// lambda_i = 0.
struct Complementarity {
  linalg::Vector lambda;
  std::vector<int> mode;         ///< 1, -1 where the surface is left to that side; 0 where it is slid on
  bool unique_velocity = false;  ///< y is the same for all solutions: D W + W^T D <= 0 for a positive diagonal D
};

/// Solves that as a problem of boxes, and reads the mode from it: surfaces whose y is below `tolerance` relative to its
/// terms are slid on. Not every W has a solution that this finds: the caller checks the mode by its own field.
/// Cost: that of solve_point with m boxes.
[[nodiscard]] Complementarity solve_complementarity(const linalg::Matrix& effects, const linalg::Vector& constant,
                                                    double tolerance);

}  // namespace saltus::switching
