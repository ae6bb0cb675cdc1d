// Contacts of a system, in its expressions.
#pragma once

#include <vector>

#include <casadi/core/sx.hpp>

#include "saltus/model/mechanics/contact.hpp"

namespace saltus::model {

/// Holds the contacts of a mechanical system M dv/dt = h + N lambda_n + T lambda_t, dq/dt = v, with m contacts and n
/// positions. N = grad gap, T the tangents as written (0 without friction). Rows are ordered by normals, first
/// tangents, second tangents if there are any: r = m, 2 m or 3 m. All expressions are over the symbols of the system;
/// those of forces are for the activities whose constants they hold.
struct ContactSystem {
  std::vector<Contact> contacts;
  std::vector<int> positions, velocities;  ///< states

  casadi::SX gap;                             ///< m
  casadi::SX velocity;                        ///< r: rates of the gaps, then tangential velocities
  casadi::SX rows;                            ///< r x n: N', then T'
  casadi::SX responses;                       ///< n x r: M^-1 (N, T)
  casadi::SX acceleration;                    ///< r: rates of `velocity` without contact forces
  casadi::SX activities;                      ///< Activity::constants x m: symbols of what Activity::values() has
  casadi::SX cone;                            ///< r - m: a tangential force that does not hold is -cone normal force
  casadi::SX normal_force, tangential_force;  ///< m and r - m
  casadi::SX forces;  ///< r: symbols of them where whoever evaluates the system solves for them; else empty
  casadi::SX friction, restitution;  ///< m each, over parameters

  [[nodiscard]] bool empty() const { return contacts.empty(); }
};

}  // namespace saltus::model
