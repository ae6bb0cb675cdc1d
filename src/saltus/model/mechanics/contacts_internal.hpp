// [[contacts]] become forces, modes and jumps.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "saltus/model/description.hpp"
#include "saltus/model/mechanics/mechanics_internal.hpp"
#include "saltus/model/mechanics/symbolic_ldl_internal.hpp"

namespace saltus::model {

/// Resolves all [[contacts]] of a description.
[[nodiscard]] Expected<std::vector<ContactStatement>> contacts_of(const Description& description, ModelScope& scope,
                                                                  const Statement& statement,
                                                                  const MechanicsStatement& mechanics);

/// Holds what the contacts of a mechanical system need of it.
struct MotionWithoutContacts {
  const std::vector<int>& positions;
  const std::vector<int>& velocities;
  const SymbolicLdl& mass;
  const casadi::SX& force;  ///< n: everything but contact forces
};

/// Appends jumps and outputs of contacts, of which the motion is known, to the statement and fills statement.contacts.
/// @return their forces, r x 1
[[nodiscard]] casadi::SX state_contact_modes(Recognition& recognition, Statement& statement, ContactSystem system,
                                             std::vector<SourceLocation> locations);

/// Appends jumps and outputs of the contacts to the statement and fills statement.contacts.
/// @return the total force with those of the contacts, n x 1; or the mistake: a gap of more than positions, parameters
///         and time, one that is negative at the start or has no position; friction or restitution out of range,
///         friction without a tangent
[[nodiscard]] Expected<casadi::SX> add_contacts(Recognition& recognition, Statement& statement,
                                                const std::vector<ContactStatement>& contacts,
                                                const MotionWithoutContacts& motion);

}  // namespace saltus::model
