// Rows of which none depends on the others.
#pragma once

#include <algorithm>

#include "saltus/linalg/matrix.hpp"

namespace saltus::linalg {

/// Collects rows that do not depend on each other, as an orthonormal basis of what they span. A row depends on those
/// that were taken where they leave less of it than `dependent`, relative to it; rows of zeros are never taken.
/// Cost of a row: its size times the number of those that were taken.
class RowBasis {
 public:
  /// @param columns  of a row
  /// @param most     rows that may be taken
  RowBasis(Index columns, Index most, double dependent)
      : basis_(columns, std::min(columns, most)), part_(columns), dependent_(dependent) {}

  [[nodiscard]] Index size() const { return taken_; }
  /// Forgets what was taken behind the first rows.
  void shrink(Index size) { taken_ = std::min(taken_, size); }
  /// Returns whether a row depends on those that were taken.
  [[nodiscard]] bool spans(ConstView row) { return !leaves_part(row); }
  /// Adds a row unless it depends on those that were taken.
  bool takes(ConstView row) {
    if (!leaves_part(row)) return false;
    basis_.col(taken_++) = part_ / part_.norm();
    return true;
  }

 private:
  /// Finds the part beside the rows that were taken. Twice: what is left first of a row that nearly depends on them is
  /// rounding.
  [[nodiscard]] bool leaves_part(ConstView row) {
    part_ = row;
    const double size = part_.norm();
    for (int pass = 0; pass < 2 && taken_ > 0; ++pass) {
      for (Index k = 0; k < taken_; ++k) part_.add_scaled(-basis_.col(k).dot(part_), basis_.col(k));
    }
    return taken_ < basis_.cols() && part_.norm() > dependent_ * size;
  }

  Matrix basis_;  ///< columns
  Index taken_ = 0;
  Vector part_;
  double dependent_;
};

}  // namespace saltus::linalg
