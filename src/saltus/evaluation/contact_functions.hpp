// Contacts of a system at one point, in numbers.
#pragma once

#include "saltus/linalg/matrix.hpp"

namespace saltus::evaluation {

/// Holds values of m contacts with r rows and n velocities; see model::ContactSystem.
struct ContactValues {
  using Rows = linalg::Matrix;
  linalg::Vector gap;                    ///< m
  linalg::Vector velocity;               ///< r
  Rows rows;                             ///< r x n
  Rows responses;                        ///< n x r
  linalg::Vector acceleration;           ///< r, without contact forces
  linalg::Vector friction, restitution;  ///< m
};

}  // namespace saltus::evaluation
