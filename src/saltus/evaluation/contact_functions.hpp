// Contacts of a system at one point, in numbers.
#pragma once

#include <Eigen/Core>

namespace saltus::evaluation {

/// Of m contacts and n velocities; see model::ContactSystem.
struct ContactValues {
  using Rows = Eigen::MatrixXd;
  Eigen::VectorXd gap;                    ///< m
  Eigen::VectorXd velocity;               ///< 2 m
  Rows rows;                              ///< 2 m x n
  Rows responses;                         ///< n x 2 m
  Eigen::VectorXd acceleration;           ///< 2 m, without contact forces
  Eigen::VectorXd friction, restitution;  ///< m
};

}  // namespace saltus::evaluation
