// Contacts at one instant, in numbers.
#pragma once

#include <vector>

#include <Eigen/Core>

namespace saltus::event_integrator {

/// m contacts: vectors over them have the normal parts first, then the tangential ones (0 without friction).
struct ContactPoint {
  Eigen::MatrixXd influence;                  ///< 2 m x 2 m: d velocity / d impulse, (N, T)' M^-1 (N, T)
  Eigen::VectorXd velocity;                   ///< 2 m
  Eigen::VectorXd acceleration;               ///< 2 m, without contact forces
  double terms = 0.0;                         ///< the largest sum of the sizes of the terms of an acceleration
  std::vector<double> friction, restitution;  ///< m; friction 0: frictionless

  [[nodiscard]] int contacts() const { return static_cast<int>(friction.size()); }
  [[nodiscard]] double normal_velocity(int i) const { return velocity(i); }
  [[nodiscard]] double tangential_velocity(int i) const { return velocity(contacts() + i); }
};

/// Unknown forces or impulses y of contacts, in forces = given + columns y, that keep the rows `held` of
/// start + influence forces at 0; the least ones where rows depend on each other.
struct HeldRows {
  Eigen::VectorXd given;
  Eigen::MatrixXd columns;
  std::vector<int> held;

  explicit HeldRows(int contacts) : given(Eigen::VectorXd::Zero(2 * contacts)), columns(2 * contacts, 0) {}
  /// One more unknown and its row; returns its number.
  int hold(int row);
  /// The forces; nothing where the rows contradict each other.
  [[nodiscard]] bool solve(const Eigen::MatrixXd& influence, const Eigen::VectorXd& start,
                           Eigen::VectorXd& forces) const;
};

}  // namespace saltus::event_integrator
