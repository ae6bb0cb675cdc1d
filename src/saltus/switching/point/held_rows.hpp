// Equations of a problem of complementarity where it is known which unknowns are at their bounds.
#pragma once

#include <optional>
#include <vector>

#include "saltus/linalg/matrix.hpp"

namespace saltus::switching {

/// Holds n <= r unknowns of z, beside given ones, that keep as many rows of w + W z at 0; the least ones where
/// rows depend on each other.
class HeldRows {
 public:
  explicit HeldRows(linalg::Index rows) : given_(linalg::Vector::zero(rows)) {}
  /// Forgets all rows, and keeps the memory.
  void clear();
  /// Adds one more unknown, that of a row that is held; returns its number.
  int hold(int row);
  /// Gives a value to one whose row is not held.
  void give(int row, double value) { given_(row) = value; }
  /// Gives a row this part of an unknown, or this value where the number of the unknown is negative.
  void share(int row, int unknown, double part);
  [[nodiscard]] const std::vector<int>& held() const { return held_; }
  enum class Solution { none, one, open };
  /// Finds z; none where the rows contradict each other, one of many where they depend on each other.
  [[nodiscard]] Solution solve(const linalg::Matrix& effects, const linalg::Vector& constant, linalg::Vector& z);
  /// Returns, as columns, changes of z that leave the held rows as they are.
  [[nodiscard]] linalg::Matrix open(const linalg::Matrix& effects) const;

  static constexpr double dependent = 1e-11;  ///< rows that depend on each other to rounding

 private:
  static constexpr double contradiction = 1e-8;  ///< relative, of rows
  struct Share {
    int row, unknown;
    double part;
  };
  [[nodiscard]] linalg::Matrix rows_of(const linalg::Matrix& effects) const;
  [[nodiscard]] std::optional<Solution> eliminate(const linalg::Matrix& effects);
  void substitute_back();
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

}  // namespace saltus::switching
