// The selections of sliding on many surfaces of which each depends on few others.
#pragma once

#include <vector>

#include "saltus/linalg/matrix.hpp"
#include "saltus/linalg/sparse.hpp"
#include "saltus/linalg/sparse_factors.hpp"
#include "saltus/switching/sparse/influence.hpp"
#include "saltus/switching/table/projected_field.hpp"

namespace saltus::switching {

/// Finds G = dg/dalpha of multi-affine g with the entries that `influence` allows (the diagonal among them), by as many
/// evaluations as there are colours of selections.
class SparseEffects {
 public:
  explicit SparseEffects(const Influence& influence);

  /// Finds G at one point.
  /// @param alpha  m selections; changed during the call and put back
  /// @param g      g(alpha), m
  void find(ProjectedField field, double* alpha, const double* g);
  [[nodiscard]] const linalg::SparseColumns& matrix() const { return matrix_; }
  [[nodiscard]] int colours() const { return colours_; }
  [[nodiscard]] const std::vector<int>& colour() const { return colour_; }

 private:
  int colours_ = 0;
  std::vector<int> colour_;
  std::vector<double> shifted_, here_;
  linalg::SparseColumns matrix_;
};

/// Applies Newton's method to g(alpha) = 0 with a sparse G: SelectionNewton of many surfaces.
class SparseNewton {
 public:
  explicit SparseNewton(const Influence& influence);

  /// Does what SelectionNewton::solve does. Cost: colours + 1 evaluations of g and a sparse factorisation per
  /// iteration.
  bool solve(ProjectedField g, double* alpha);
  /// Returns G at the last point where it was formed.
  [[nodiscard]] const linalg::SparseColumns& jacobian() const { return effects_.matrix(); }

 private:
  SparseEffects effects_;
  bool analysed_ = false;
  linalg::SparseLu lu_;
  linalg::Vector g_, step_;
};

}  // namespace saltus::switching
