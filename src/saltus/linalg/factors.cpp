#include "saltus/linalg/factors.hpp"

#include <cmath>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/QR>

#include "saltus/base/at.hpp"
#include "saltus/base/contracts.hpp"
#include "saltus/linalg/eigen_internal.hpp"
#include "saltus/linalg/hidden_internal.hpp"

namespace saltus::linalg {
namespace {

constexpr Index many = 48;  ///< from here on Eigen's blocks pay

/// Column by column, rows swapped to the largest entry.
void eliminate(Matrix& a, std::vector<Index>& pivots) {
  const Index n = a.rows();
  for (Index k = 0; k < n; ++k) {
    double* const column = a.data() + k * n;
    Index pivot = k;
    for (Index i = k + 1; i < n; ++i) {
      if (std::abs(column[i]) > std::abs(column[pivot])) pivot = i;
    }
    pivots[at(k)] = pivot;
    if (pivot != k) {
      for (Index j = 0; j < n; ++j) std::swap(a(k, j), a(pivot, j));
    }
    if (column[k] == 0.0) continue;
    for (Index i = k + 1; i < n; ++i) column[i] /= column[k];
    for (Index j = k + 1; j < n; ++j) {
      double* const other = a.data() + j * n;
      const double factor = other[k];
      for (Index i = k + 1; i < n; ++i) other[i] -= column[i] * factor;
    }
  }
}

/// L of A = L L' in the place of the lower triangle of A. False where a pivot is not positive.
bool take_roots(Matrix& a) {
  const Index n = a.rows();
  for (Index k = 0; k < n; ++k) {
    double* const column = a.data() + k * n;
    if (!(column[k] > 0.0)) return false;
    column[k] = std::sqrt(column[k]);
    for (Index i = k + 1; i < n; ++i) column[i] /= column[k];
    for (Index j = k + 1; j < n; ++j) {
      double* const other = a.data() + j * n;
      for (Index i = j; i < n; ++i) other[i] -= column[i] * column[j];
    }
  }
  return true;
}

}  // namespace

void Lu::compute(ConstView a) {
  SALTUS_ASSERT(a.rows() == a.cols());
  factors_ = a;
  const Index n = a.rows();
  pivots_.resize(at(n));
  if (n < many) return eliminate(factors_, pivots_);
  Eigen::Map<Eigen::MatrixXd> own(factors_.data(), n, n);
  Eigen::Transpositions<Eigen::Dynamic, Eigen::Dynamic, Index> swaps(n);
  Index count = 0;
  Eigen::internal::partial_lu_inplace(own, swaps, count);
  for (Index k = 0; k < n; ++k) pivots_[at(k)] = swaps.indices()[k];
}

void Lu::solve_in_place(View right) const {
  const Index n = factors_.rows();
  SALTUS_ASSERT(right.rows() == n);
  for (Index column = 0; column < right.cols(); ++column) {
    View b = right.col(column);
    for (Index k = 0; k < n; ++k) {
      if (pivots_[at(k)] != k) std::swap(b[k], b[pivots_[at(k)]]);
    }
    for (Index k = 0; k < n; ++k) {
      const double* const own = factors_.data() + k * n;
      for (Index i = k + 1; i < n; ++i) b[i] -= own[i] * b[k];
    }
    for (Index k = n - 1; k >= 0; --k) {
      const double* const own = factors_.data() + k * n;
      b[k] /= own[k];
      for (Index i = 0; i < k; ++i) b[i] -= own[i] * b[k];
    }
  }
}

Matrix Lu::solve(ConstView right) const {
  Matrix solution(right);
  solve_in_place(solution);
  return solution;
}

double Lu::determinant() const {
  double product = 1.0;
  for (Index k = 0; k < factors_.rows(); ++k) product *= pivots_[at(k)] == k ? factors_(k, k) : -factors_(k, k);
  return product;
}

struct FullLu::Parts {
  Eigen::FullPivLU<Eigen::MatrixXd> factors;
};
void FullLu::set_threshold(double threshold) { parts_->factors.setThreshold(threshold); }
void FullLu::compute(ConstView a) { parts_->factors.compute(eigen(a)); }
Index FullLu::rank() const { return parts_->factors.rank(); }
bool FullLu::is_invertible() const { return parts_->factors.isInvertible(); }
Index FullLu::dimension_of_kernel() const { return parts_->factors.dimensionOfKernel(); }
Matrix FullLu::kernel() const { return matrix_of(parts_->factors.kernel()); }
double FullLu::last_pivot() const {
  const auto& matrix = parts_->factors.matrixLU();
  return matrix.size() == 0 ? 0.0 : std::abs(matrix(matrix.rows() - 1, matrix.cols() - 1));
}
Matrix FullLu::inverse() const { return solve(Matrix::identity(parts_->factors.rows(), parts_->factors.rows())); }
Matrix FullLu::solve(ConstView right) const { return matrix_of(parts_->factors.solve(eigen(right))); }

struct PivotedQr::Parts {
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> factors;
};
void PivotedQr::set_threshold(double threshold) { parts_->factors.setThreshold(threshold); }
void PivotedQr::compute(ConstView a) { parts_->factors.compute(eigen(a)); }
Index PivotedQr::rank() const { return parts_->factors.rank(); }
Matrix PivotedQr::solve(ConstView right) const { return matrix_of(parts_->factors.solve(eigen(right))); }
Matrix PivotedQr::times_q(ConstView b) const {
  return matrix_of(parts_->factors.householderQ() * Eigen::MatrixXd(eigen(b)));
}
std::vector<Index> PivotedQr::column_order() const {
  const auto& order = parts_->factors.colsPermutation().indices();
  return {order.begin(), order.end()};
}

struct OrthogonalFactors::Parts {
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> factors;
};
void OrthogonalFactors::set_threshold(double threshold) { parts_->factors.setThreshold(threshold); }
void OrthogonalFactors::compute(ConstView a) { parts_->factors.compute(eigen(a)); }
Index OrthogonalFactors::rank() const { return parts_->factors.rank(); }
Matrix OrthogonalFactors::solve(ConstView right) const { return matrix_of(parts_->factors.solve(eigen(right))); }
Matrix OrthogonalFactors::null_space() const {
  const auto& factors = parts_->factors;
  const Eigen::MatrixXd basis = factors.matrixZ().transpose().rightCols(factors.cols() - factors.rank());
  return matrix_of(factors.colsPermutation() * basis);
}
Matrix OrthogonalFactors::pseudo_inverse() const {
  return solve(Matrix::identity(parts_->factors.rows(), parts_->factors.rows()));
}

void Cholesky::compute(ConstView a) {
  SALTUS_ASSERT(a.rows() == a.cols());
  factors_ = a;
  const Index n = a.rows();
  if (n < many) {
    is_positive_ = take_roots(factors_);
  } else {
    Eigen::Map<Eigen::MatrixXd> own(factors_.data(), n, n);
    is_positive_ = Eigen::internal::llt_inplace<double, Eigen::Lower>::blocked(own) == -1;
  }
}

Matrix Cholesky::solve(ConstView right) const {
  Matrix solution(right);
  solve_in_place(solution);
  return solution;
}

void Cholesky::solve_in_place(View right) const {
  const Index n = factors_.rows();
  SALTUS_ASSERT(right.rows() == n);
  for (Index column = 0; column < right.cols(); ++column) {
    View b = right.col(column);
    for (Index k = 0; k < n; ++k) {
      const double* const own = factors_.data() + k * n;
      b[k] /= own[k];
      for (Index i = k + 1; i < n; ++i) b[i] -= own[i] * b[k];
    }
    for (Index k = n - 1; k >= 0; --k) {
      const double* const own = factors_.data() + k * n;
      for (Index i = k + 1; i < n; ++i) b[k] -= own[i] * b[i];
      b[k] /= own[k];
    }
  }
}

struct Ldl::Parts {
  Eigen::LDLT<Eigen::MatrixXd> factors;
};
void Ldl::compute(ConstView a) { parts_->factors.compute(eigen(a)); }
bool Ldl::is_factorised() const { return parts_->factors.info() == Eigen::Success; }
bool Ldl::is_positive() const { return parts_->factors.isPositive(); }
Vector Ldl::pivots() const { return matrix_of(parts_->factors.vectorD()); }
Matrix Ldl::solve(ConstView right) const {
  Matrix solution(right);
  solve_in_place(solution);
  return solution;
}
void Ldl::solve_in_place(View right) const {
  auto own = eigen(right);
  parts_->factors.solveInPlace(own);
}

Matrix least_squares(ConstView a, ConstView right) { return OrthogonalFactors(a).solve(right); }
double determinant(ConstView a) { return Lu(a).determinant(); }
Matrix inverse(ConstView a) { return Lu(a).solve(Matrix::identity(a.rows(), a.rows())); }

template class Hidden<FullLu::Parts>;
template class Hidden<PivotedQr::Parts>;
template class Hidden<OrthogonalFactors::Parts>;
template class Hidden<Ldl::Parts>;

}  // namespace saltus::linalg
