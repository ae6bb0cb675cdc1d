// A contact of a system, without its expressions.
#pragma once

#include <array>
#include <cstdint>
#include <string>

namespace saltus::model {

/// Of coefficients of friction: what counts as 0 where one varies. A touching body leaves 0 where it is twice as large.
inline constexpr double no_friction = 1e-12;

/// Holds a unilateral constraint gap >= 0 with a normal force, and with friction along a tangent, or in the plane of
/// two.
struct Contact {
  std::string name;
  bool has_gap = true;  ///< else dry friction in a plane as it is: always closed, with the normal force 1
  bool has_friction = false;
  bool friction_varies = false;  ///< with positions or t: its last guard says where the coefficient turns negative
  bool in_plane = false;         ///< two tangents, with friction
  int jump = -1;                 ///< in System::jumps: where it opens, closes, sticks or slips

  /// Returns the number of tangents along which impulses are told.
  [[nodiscard]] int tangents() const { return in_plane ? 2 : 1; }
};

/// Holds how a contact takes part in a mode. The expressions of its forces and guards read it as constants.
struct Activity {
  enum class State : std::int8_t {
    open,
    closed,  ///< without friction, or where its coefficient is 0
    stick,   ///< the tangential velocity is 0
    slip     ///< it is not
  };

  State state = State::open;
  bool carries = false;         ///< closed, and its normal force is the one that holds the gap (others follow from it)
  std::array<bool, 2> holds{};  ///< by tangent: the tangential force holds the tangential velocity at 0
  std::array<double, 2> share{};  ///< in [-1, 1]: unless it holds, tangential force = -share friction normal force; in
                                  ///< a plane only while it does not slip: slip has the direction of its velocity
  std::array<double, 2> speeds{1.0, 1.0};     ///< in a plane: squares of speeds between which a slip goes on
  double force_unit = 1.0, speed_unit = 1.0;  ///< the sizes of forces and velocities in this mode, > 0

  bool operator==(const Activity&) const = default;
  [[nodiscard]] bool is_closed() const { return state != State::open; }

  /// Says which constant of an expression is which.
  enum Constant : std::uint8_t {
    closed,
    carrying,
    smooth,  ///< closed without friction
    slipping,
    holding,            ///< two
    sharing = 6,        ///< two
    least_speed = 8,    ///< its square
    largest_speed = 9,  ///< likewise
    unit_of_forces,
    unit_of_speeds,
    constants  ///< how many there are
  };
  /// Returns the values of these constants.
  [[nodiscard]] std::array<double, constants> values() const {
    const auto number = [](bool truth) { return truth ? 1.0 : 0.0; };
    return {number(is_closed()),
            number(carries),
            number(state == State::closed),
            number(state == State::slip),
            number(holds[0]),
            number(holds[1]),
            share[0],
            share[1],
            speeds[0],
            speeds[1],
            force_unit,
            speed_unit};
  }
};

}  // namespace saltus::model
