// Rows of a matrix that do not depend on each other.
#pragma once

#include "saltus/linalg/matrix.hpp"

namespace saltus::event_integrator {

/// Collects rows that do not depend on each other: those that may be held at once.
class RowBasis {
 public:
  explicit RowBasis(const linalg::Matrix& rows) : rows_(rows), basis_(rows.cols(), rows.cols()), part_(rows.cols()) {}
  [[nodiscard]] bool holds(int row) { return !leaves_part(row); }
  /// Adds a row unless it depends on those that were taken.
  bool takes(int row) {
    if (!leaves_part(row)) return false;
    basis_.col(taken_++) = part_ / part_.norm();
    return true;
  }

 private:
  /// Finds the part beside the rows that were taken.
  [[nodiscard]] bool leaves_part(int row) {
    part_ = rows_.row(row);
    const double size = part_.norm();
    for (int twice = 0; twice < 2 && taken_ > 0; ++twice) {
      for (linalg::Index k = 0; k < taken_; ++k) part_.add_scaled(-basis_.col(k).dot(part_), basis_.col(k));
    }
    return taken_ < basis_.cols() && part_.norm() > 1e-9 * size;
  }

  const linalg::Matrix& rows_;
  linalg::Matrix basis_;  ///< columns
  linalg::Index taken_ = 0;
  linalg::Vector part_;
};

}  // namespace saltus::event_integrator
