// What contacts do to a motion, before anybody says how they are treated.
#pragma once

#include <vector>

#include "saltus/model/mechanics/contacts_internal.hpp"

namespace saltus::model {

/// Finds gaps, normals, tangents and the response of the motion to them; the entries of `contacts` have name and
/// friction.
/// @return the mistake: a gap of more than positions, parameters and time, one that is negative at the start or has no
///         position; friction or restitution out of range, friction without a tangent
[[nodiscard]] Expected<ContactSystem> contact_motion(Recognition& recognition, Statement& statement,
                                                     const std::vector<ContactStatement>& contacts,
                                                     const MotionWithoutContacts& motion);

}  // namespace saltus::model
