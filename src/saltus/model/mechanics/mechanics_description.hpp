// [mechanics] and [[contacts]] as they are written.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "saltus/base/error.hpp"
#include "saltus/expression/syntax_tree.hpp"

namespace saltus::model {

/// Says where the terms of a mass matrix that depends on the positions come from.
enum class Coriolis {
  in_force,   ///< the user's `force` has them
  from_mass,  ///< dM/dt v - grad_q(v'M v)/2 is subtracted
};

/// Holds a state named in a list.
struct StateName {
  std::string name;
  SourceLocation location;
};

/// Holds a generalised force on a velocity.
struct ForceDescription {
  std::string velocity;
  expression::NodePtr force;
  SourceLocation location;
};

/// Holds a line through points of the plane, or a disc around one; for the report.
struct DrawnDescription {
  std::vector<std::array<expression::NodePtr, 2>> points;
  expression::NodePtr radius;  ///< null for a line
  SourceLocation location;
};

/// States M(q) dv/dt = force - grad potential - coriolis, dq/dt = v.
struct MechanicsDescription {
  std::vector<StateName> positions, velocities;        ///< in the same order
  std::vector<std::vector<expression::NodePtr>> mass;  ///< rows; empty: identity
  expression::NodePtr potential;                       ///< null: 0
  Coriolis coriolis = Coriolis::in_force;
  std::vector<ForceDescription> force;
  std::vector<DrawnDescription> draw;
  SourceLocation location, mass_location;
};

/// Holds an entry of a tangent: a position and its coefficient.
struct TangentEntry {
  std::string position;
  expression::NodePtr value;
  SourceLocation location;
};

/// Holds one of [[contacts]]: gap >= 0, friction along the tangents.
struct ContactDescription {
  std::string name;
  expression::NodePtr gap;
  std::vector<std::vector<TangentEntry>> tangents;  ///< none: frictionless
  expression::NodePtr friction, restitution;        ///< null: 0
  SourceLocation location;
};

}  // namespace saltus::model
