// The forces of contacts that last: one problem of complementarity.
#pragma once

#include <optional>
#include <vector>

#include "saltus/event_integrator/contact/contact_point.hpp"
#include "saltus/switching/point/point_solver.hpp"

namespace saltus::event_integrator {

using ContactMode = switching::Face;
/// Holds modes of all contacts, and their forces z and accelerations y, r each.
using ContactForces = switching::PointSolution;

/// States for contacts at rest (gap and its rate 0): 0 <= normal force, complementary to 0 <= normal acceleration;
/// |tangential force| <= friction normal force, with equality against the slip or, where there is none, against the
/// tangential acceleration. Contacts that are not in `resting` are open. It keeps references to the point.
[[nodiscard]] switching::PointProblem problem_of(const ContactPoint& point, const std::vector<int>& resting);

/// Finds the forces of contacts at rest (switching::solve_point), in parts that do nothing to each other.
[[nodiscard]] switching::PointSolutions forces_of(const ContactPoint& point, const std::vector<int>& resting,
                                                  const switching::FaceHints& hints);

/// Finds the forces in given modes. False where the modes contradict each other.
[[nodiscard]] bool forces_in(const ContactPoint& point, const std::vector<int>& resting,
                             const std::vector<ContactMode>& modes, ContactForces& result);

/// Returns rates of impulses in a piece of an impact by complementary pivots; nothing where these end on a ray. They
/// are 1 for contacts that push, in [0, 1] for those that are at rest, 0 for those that leave; with friction against
/// `velocity`.
[[nodiscard]] std::optional<switching::PointVertex> rates_by_pivots(const ContactPoint& point,
                                                                    const std::vector<int>& touching,
                                                                    const linalg::Vector& velocity,
                                                                    const std::vector<bool>& pushing);

}  // namespace saltus::event_integrator
