// A contact of a system, without its expressions.
#pragma once

#include <string>

namespace saltus::model {

/// Of coefficients of friction: what counts as 0 where one varies. A touching body leaves 0 where it is twice as large.
inline constexpr double no_friction = 1e-12;

/// Holds a unilateral constraint gap >= 0 with a normal force, and with friction along a tangent, or in the plane of
/// two.
///
/// Its mode is kept in discrete states of the system, behind all others: each is 0 or 1, but for `share` and those
/// behind it.
struct Contact {
  std::string name;
  bool has_gap = true;  ///< else dry friction in a plane as it is: always closed, with the normal force 1
  bool has_friction = false;
  bool friction_varies = false;  ///< with positions or t: its last guard says where the coefficient turns negative
  bool in_plane = false;  ///< two tangents, with friction: `stick`, `share` and the tangential impulse are two states
  int jump = -1;          ///< in System::jumps: where it opens, closes, sticks or slips

  int closed = -1;      ///< state: the gap is held at 0
  int active = -1;      ///< state: closed, and its normal force is the one that holds the gap (others follow from it)
  int stick = -1;       ///< state: the tangential force holds the tangential velocity at 0
  int slip = -1;        ///< state: the tangential velocity is not 0
  int share = -1;       ///< state in [-1, 1]: unless it sticks, tangential force = -share friction normal force; in a
                        ///< plane only while it does not slip: slip has the direction of its velocity
  int smooth = -1;      ///< state, where friction varies: closed, and the coefficient is 0 there
  int speeds = -1;      ///< two states, in a plane: squares of speeds between which a slip goes on
  int force_unit = -1;  ///< state: the size of forces in this mode, > 0
  int speed_unit = -1;  ///< state: the size of velocities in this mode, > 0
  int impulse = -1;     ///< state: of the normal impulse at this time, and behind it of the tangential one

  /// Returns the number of tangents that have states.
  [[nodiscard]] int tangents() const { return in_plane ? 2 : 1; }
};

}  // namespace saltus::model
