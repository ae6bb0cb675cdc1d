// The forces of contacts that last.
#pragma once

#include <vector>

#include "saltus/event_integrator/contact/contact_point.hpp"
#include "saltus/linalg/matrix.hpp"

namespace saltus::event_integrator {

enum class ContactMode {
  open,
  closed,  ///< frictionless
  stick,
  slip_up,    ///< along the tangent
  slip_down,  ///< against it
  slip        ///< in the plane of two tangents
};
[[nodiscard]] constexpr bool slips(ContactMode mode) { return mode >= ContactMode::slip_up; }

/// Holds modes of all contacts, and their forces.
struct ContactForces {
  std::vector<ContactMode> modes;
  std::vector<linalg::Vector> directions;  ///< by contact, of slip: unit vectors over its tangents; 0 without
  /// Closed contacts that others keep closed: of forces that the motion leaves open those are taken that need the
  /// fewest contacts.
  std::vector<int> idle;
  bool is_open = false;         ///< other forces would do, those of idle contacts aside
  linalg::Vector forces;        ///< r
  linalg::Vector acceleration;  ///< r, with them
  /// What is left until the first of the modes ends, relative to its terms: a normal force or acceleration, the
  /// distance to the edge of a friction cone. Negative: a mode does not hold.
  double margin = 0.0;
};

/// Finds the forces in given modes; contacts that are not in `resting` are open. False where the modes contradict each
/// other.
[[nodiscard]] bool forces_in(const ContactPoint& point, const std::vector<int>& resting,
                             const std::vector<ContactMode>& modes, ContactForces& result);

/// Solves anew with other contacts idle; returns whether the modes still hold.
[[nodiscard]] bool carry_without(const ContactPoint& point, const std::vector<int>& resting,
                                 const std::vector<int>& idle, ContactForces& found);

/// Returns the modes in which contacts at rest (gap and its rate 0) may go on: 0 <= normal force, complementary to 0 <=
/// normal acceleration; |tangential force| <= friction normal force, with equality against the slip or, where there is
/// none, against the tangential acceleration. Found by trying all combinations, those with most contact first.
/// @param excluded  by contact: a mode that is known to end here; open contacts have no say
[[nodiscard]] std::vector<ContactForces> admissible_forces(const ContactPoint& point, const std::vector<int>& resting,
                                                           const std::vector<std::vector<ContactMode>>& excluded);

/// Returns whether all modes that were found give one motion, whatever forces are taken of those that the chosen one
/// leaves open.
[[nodiscard]] bool have_one_motion(const ContactPoint& point, const std::vector<int>& resting,
                                   const std::vector<ContactForces>& found, std::size_t chosen);

}  // namespace saltus::event_integrator
