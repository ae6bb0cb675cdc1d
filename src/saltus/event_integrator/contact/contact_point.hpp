// Contacts at one instant, in numbers.
#pragma once

#include <optional>
#include <vector>

#include "saltus/base/function_ref.hpp"
#include "saltus/linalg/matrix.hpp"

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

/// Holds n <= r unknown forces or impulses of contacts, beside given ones, that keep as many rows of start + influence
/// forces at 0; the least ones where rows depend on each other.
class HeldRows {
 public:
  explicit HeldRows(linalg::Index rows) : given_(linalg::Vector::zero(rows)) {}
  /// Forgets all rows, and keeps the memory.
  void clear();
  /// Adds one more unknown, the force of a row that is held; returns its number.
  int hold(int row);
  /// Gives the normal force 1 to a contact whose row is not held.
  void give(int row) { given_(row) = 1.0; }
  /// Gives a row this part of an unknown, or of the given force 1 where its number is negative.
  void share(int row, int unknown, double part);
  [[nodiscard]] const std::vector<int>& held() const { return held_; }
  enum class Solution { none, one, open };
  /// Finds the forces; none where the rows contradict each other, one of many where they depend on each other.
  [[nodiscard]] Solution solve(const linalg::Matrix& influence, const linalg::Vector& start, linalg::Vector& forces);
  /// Returns, as columns, forces that leave the held rows as they are.
  [[nodiscard]] linalg::Matrix open(const linalg::Matrix& influence) const;

  static constexpr double dependent = 1e-11;  ///< rows that depend on each other to rounding

 private:
  static constexpr double contradiction = 1e-8;  ///< relative, of rows
  struct Share {
    int row, unknown;
    double part;
  };
  [[nodiscard]] linalg::Matrix rows_of(const linalg::Matrix& influence) const;
  [[nodiscard]] std::optional<Solution> eliminate(const linalg::Matrix& influence);
  [[nodiscard]] Solution solve_least(std::size_t rank, double largest);
  template <class Unknowns, class Forces>
  void add(const Unknowns& unknowns, Forces& forces) const;

  linalg::Vector given_;
  std::vector<int> held_;
  std::vector<Share> shares_;  ///< of what is unknown, by ascending unknowns
  std::vector<double> table_;  ///< memory of an elimination
  std::vector<int> order_;     ///< likewise
  linalg::Vector right_, unknowns_;
};

/// Finds the directions in which contacts begin to slip from rest: along the rates of their tangential velocities,
/// which follow from the directions.
/// @param free        contacts that begin to slip, in a plane each
/// @param directions  by contact, unit vectors: those of `free` are found, from what they are
/// @param solve       finds forces and rates (r each) for the directions; returns false where there are none
/// @return false where solve does, or nothing is found
[[nodiscard]] bool find_directions(const ContactPoint& point, const std::vector<int>& free,
                                   std::vector<linalg::Vector>& directions, const linalg::Vector& forces,
                                   const linalg::Vector& rates, FunctionRef<bool()> solve);

}  // namespace saltus::event_integrator
