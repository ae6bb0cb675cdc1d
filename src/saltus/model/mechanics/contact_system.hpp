// Contacts of a system, in its expressions.
#pragma once

#include <string>
#include <vector>

#include <casadi/core/sx.hpp>

namespace saltus::model {

/// Holds a unilateral constraint gap >= 0 with a normal force, and with friction along a tangent, or in the plane of
/// two.
///
/// Its mode is kept in discrete states of the system, behind all others: each is 0 or 1, but for `share` and those
/// behind it.
struct Contact {
  std::string name;
  bool has_gap = true;  ///< else dry friction in a plane as it is: always closed, with the normal force 1
  bool has_friction = false;
  bool in_plane = false;  ///< two tangents, with friction: `stick`, `share` and the tangential impulse are two states
  int jump = -1;          ///< in System::jumps: where it opens, closes, sticks or slips

  int closed = -1;      ///< state: the gap is held at 0
  int active = -1;      ///< state: closed, and its normal force is the one that holds the gap (others follow from it)
  int stick = -1;       ///< state: the tangential force holds the tangential velocity at 0
  int slip = -1;        ///< state: the tangential velocity is not 0
  int share = -1;       ///< state in [-1, 1]: unless it sticks, tangential force = -share friction normal force; in a
                        ///< plane only while it does not slip: slip has the direction of its velocity
  int speeds = -1;      ///< two states, in a plane: squares of speeds between which a slip goes on
  int force_unit = -1;  ///< state: the size of forces in this mode, > 0
  int speed_unit = -1;  ///< state: the size of velocities in this mode, > 0
  int impulse = -1;     ///< state: of the normal impulse at this time, and behind it of the tangential one

  /// Returns the number of tangents that have states.
  [[nodiscard]] int tangents() const { return in_plane ? 2 : 1; }
};

/// Holds the contacts of a mechanical system M dv/dt = h + N lambda_n + T lambda_t, dq/dt = v, with m contacts and n
/// positions. N = grad gap, T the tangents as written (0 without friction). Rows are ordered by normals, first
/// tangents, second tangents if there are any: r = m, 2 m or 3 m. All expressions are over the symbols of the system;
/// those of forces are for the modes that the discrete states say.
struct ContactSystem {
  std::vector<Contact> contacts;
  std::vector<int> positions, velocities;  ///< states
  int first_hidden = 0;                    ///< states from here on are modes of contacts: in no column of a result

  casadi::SX gap;                             ///< m
  casadi::SX velocity;                        ///< r: rates of the gaps, then tangential velocities
  casadi::SX rows;                            ///< r x n: N', then T'
  casadi::SX responses;                       ///< n x r: M^-1 (N, T)
  casadi::SX acceleration;                    ///< r: rates of `velocity` without contact forces
  casadi::SX normal_force, tangential_force;  ///< m and r - m
  casadi::SX friction, restitution;           ///< m each, over parameters

  [[nodiscard]] bool empty() const { return contacts.empty(); }
};

}  // namespace saltus::model
