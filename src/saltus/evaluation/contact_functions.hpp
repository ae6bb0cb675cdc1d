// Contacts of a system at one point, in numbers.
#pragma once

#include <Eigen/Core>

namespace saltus::evaluation {

/// Holds values of m contacts with r rows and n velocities; see model::ContactSystem.
struct ContactValues {
  using Rows = Eigen::MatrixXd;
  Eigen::VectorXd gap;                    ///< m
  Eigen::VectorXd velocity;               ///< r
  Rows rows;                              ///< r x n
  Rows responses;                         ///< n x r
  Eigen::VectorXd acceleration;           ///< r, without contact forces
  Eigen::VectorXd friction, restitution;  ///< m
};

}  // namespace saltus::evaluation
