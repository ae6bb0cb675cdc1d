// Contacts at one instant, in numbers.
#pragma once

#include <vector>

#include "saltus/evaluation/contact_functions.hpp"
#include "saltus/linalg/matrix.hpp"
#include "saltus/model/layout.hpp"

namespace saltus::event_integrator {

/// Holds m contacts. Vectors over them have the normal parts first, then those along first tangents, then those along
/// second ones if a contact has two (0 where there is none); r = m, 2 m or 3 m.
struct ContactPoint {
  linalg::Matrix influence;                   ///< r x r: d velocity / d impulse, (N, T)' M^-1 (N, T)
  linalg::Vector velocity;                    ///< r
  linalg::Vector acceleration;                ///< r, without contact forces
  double free_terms = 0.0;                    ///< the largest sum of the sizes of the terms of `acceleration`
  double terms = 0.0;                         ///< likewise, or of what contact forces cancel of it
  std::vector<double> friction, restitution;  ///< m; friction 0: frictionless
  std::vector<int> tangents;                  ///< m; 0: frictionless
  std::vector<bool> has_gap;                  ///< m; false: always closed, with the normal force 1

  [[nodiscard]] int contacts() const { return static_cast<int>(friction.size()); }
  [[nodiscard]] bool in_plane(int i) const { return tangents[static_cast<std::size_t>(i)] == 2; }
  /// Returns the row of a tangent of a contact.
  [[nodiscard]] int tangent_row(int i, int tangent) const { return (1 + tangent) * contacts() + i; }
  [[nodiscard]] double normal_velocity(int i) const { return velocity(i); }
  /// Returns the part of a vector along both tangents of a contact; 0 along those that it has not.
  [[nodiscard]] linalg::Vector along(const linalg::Vector& vector, int i) const {
    if (tangents[static_cast<std::size_t>(i)] == 0) return linalg::Vector::zero(2);
    return {vector(tangent_row(i, 0)), in_plane(i) ? vector(tangent_row(i, 1)) : 0.0};
  }
};

/// Returns the rows of some contacts, in the order of a point that has these alone.
[[nodiscard]] std::vector<int> rows_of(const ContactPoint& point, const std::vector<int>& contacts);
/// Returns that point. Sizes of terms stay those of all.
[[nodiscard]] ContactPoint point_of(const ContactPoint& point, const std::vector<int>& contacts);
/// Returns contacts in parts that do nothing to each other, in their order.
[[nodiscard]] std::vector<std::vector<int>> parts_of(const ContactPoint& point, const std::vector<int>& contacts);

/// Reads all but the accelerations and the sizes of terms from the values of contacts at a point.
void read_contacts(const std::vector<model::Contact>& contacts, const evaluation::ContactValues& values,
                   ContactPoint& point);

}  // namespace saltus::event_integrator
