// Small dense linear systems of changing size in fixed memory.
#pragma once

#include <cstddef>
#include <vector>

#include "saltus/linalg/factors.hpp"
#include "saltus/linalg/matrix.hpp"

namespace saltus::fesd_integrator {

/// Solves A y = b by Gaussian elimination with row pivoting; by a complete orthogonal decomposition, that is the
/// solution of least norm, where A is singular to rounding (weights that are not unique).
class DenseSystem {
 public:
  void reserve(linalg::Index n) {
    memory_.resize(n * n);
    copy_.resize(n * n);
    right_.resize(n);
    right_copy_.resize(n);
    column_sizes_.resize(n);
    pivots_.resize(static_cast<std::size_t>(n));
  }
  /// Sets the size, and everything to 0.
  void reset(linalg::Index n) {
    n_ = n;
    factorised_ = false;
    matrix().set_zero();
    right().set_zero();
  }
  [[nodiscard]] linalg::View matrix() { return {memory_.data(), n_, n_}; }
  [[nodiscard]] linalg::View right() { return {right_.data(), n_}; }
  /// Leaves the solution in right(); false if something is not finite, or a singular system has none but for an error
  /// beyond `negligible` (the rounding level of the right side, as it is or in units of the largest entry of each row).
  /// Cost: n^3 / 3.
  enum class Unit { right_side, row };
  [[nodiscard]] bool solve(double negligible, Unit unit = Unit::right_side);
  /// Does the same for another right() and the matrix that was solved for last, if that was regular. Cost: n^2.
  [[nodiscard]] bool is_factorised() const { return factorised_; }
  [[nodiscard]] bool solve_again();
  /// Returns what the matrix of the last solve() maps to 0: an orthonormal basis, one column each; none if it was
  /// regular.
  [[nodiscard]] linalg::Matrix null_space() const;

 private:
  [[nodiscard]] bool keep_copy();
  [[nodiscard]] bool eliminate();
  void substitute();

  linalg::Index n_ = 0;
  bool factorised_ = false;
  linalg::Vector memory_, copy_, right_, right_copy_;
  linalg::Vector column_sizes_;        ///< largest entry of each column of the matrix as it was given
  std::vector<linalg::Index> pivots_;  ///< rows that were exchanged, in turn
  linalg::OrthogonalFactors orthogonal_;
};

}  // namespace saltus::fesd_integrator
