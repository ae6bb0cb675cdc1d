// What is drawn of the bodies of a system, in its expressions.
#pragma once

#include <casadi/core/sx.hpp>

namespace saltus::model {

/// Holds a line through points of the plane, or a disc around one; over the positions and parameters of the system.
struct DrawnShape {
  casadi::SX points;  ///< 2 x n: x and y of every point
  casadi::SX radius;  ///< of a disc; 0 x 0 for a line
};

}  // namespace saltus::model
