// Contacts of a system, in its expressions.
#pragma once

#include <string>
#include <vector>

#include <casadi/core/sx.hpp>

namespace saltus::model {

/// A unilateral constraint gap >= 0 with a normal force, and with friction along a tangent.
///
/// Its mode is kept in discrete states of the system, behind all others: each is 0 or 1, but for `share`.
struct Contact {
  std::string name;
  bool has_friction = false;
  int jump = -1;  ///< in System::jumps: where it opens, closes, sticks or slips

  int closed = -1;   ///< state: the gap is held at 0
  int active = -1;   ///< state: closed, and its normal force is the one that holds the gap (others follow from it)
  int stick = -1;    ///< state: the tangential force holds the tangential velocity at 0
  int slip = -1;     ///< state: the tangential velocity is not 0
  int share = -1;    ///< state in [-1, 1]: unless it sticks, tangential force = -share friction normal force
  int impulse = -1;  ///< state: of the normal impulse at this time, and behind it of the tangential one
};

/// The contacts of a mechanical system M dv/dt = h + N lambda_n + T lambda_t, dq/dt = v, with m contacts and n
/// positions. N = grad gap, T the tangents as written (0 without friction). All expressions are over the symbols of the
/// system; those of forces are for the modes that the discrete states say.
struct ContactSystem {
  std::vector<Contact> contacts;
  std::vector<int> positions, velocities;  ///< states
  int first_hidden = 0;                    ///< states from here on are modes of contacts: in no column of a result

  casadi::SX gap;                             ///< m
  casadi::SX velocity;                        ///< 2 m: rates of the gaps, then tangential velocities
  casadi::SX rows;                            ///< 2 m x n: N', then T'
  casadi::SX responses;                       ///< n x 2 m: M^-1 (N, T)
  casadi::SX acceleration;                    ///< 2 m: rates of `velocity` without contact forces
  casadi::SX normal_force, tangential_force;  ///< m each
  casadi::SX friction, restitution;           ///< m each, over parameters

  [[nodiscard]] bool empty() const { return contacts.empty(); }
};

}  // namespace saltus::model
