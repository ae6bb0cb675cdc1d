#include <cmath>

#include "saltus/base/at.hpp"
#include "saltus/ode/sparse/radau_systems_internal.hpp"

namespace saltus::ode {
namespace {

/// A matrix with the entries of a pattern.
template <class Scalar>
Eigen::SparseMatrix<Scalar> with_pattern(const JacobianPattern& pattern) {
  const auto n = static_cast<Eigen::Index>(pattern.columns());
  std::vector<Eigen::Triplet<Scalar>> triplets;
  for (std::size_t column = 0; column < pattern.columns(); ++column) {
    for (std::size_t k = pattern.start[column]; k < pattern.start[column + 1]; ++k) {
      triplets.emplace_back(static_cast<int>(pattern.row[k]), static_cast<int>(column), Scalar(1.0));
    }
  }
  Eigen::SparseMatrix<Scalar> matrix(n, n);
  matrix.setFromTriplets(triplets.begin(), triplets.end());
  matrix.makeCompressed();
  return matrix;
}

}  // namespace

bool RadauSystems::use(const JacobianPattern* pattern) {
  if (started_ && pattern == pattern_) return false;
  started_ = true;
  pattern_ = pattern;
  groups_.clear();
  if (pattern == nullptr) {
    jacobian_.resize(n_, n_);
    return true;
  }
  groups_ = column_groups(*pattern);
  entries_.assign(pattern->row.size(), 0.0);
  sparse_real_matrix_ = with_pattern<double>(*pattern);
  sparse_complex_matrix_ = with_pattern<std::complex<double>>(*pattern);
  sparse_real_.analyzePattern(sparse_real_matrix_);
  for (Pair& pair : pairs_) pair.sparse.analyzePattern(sparse_complex_matrix_);
  return true;
}

bool RadauSystems::set_column(Eigen::Index column, const Vector& difference, double increment) {
  if (pattern_ == nullptr) {
    jacobian_.col(column) = difference / increment;
    return jacobian_.col(column).allFinite();
  }
  const auto j = static_cast<std::size_t>(column);
  bool finite = true;
  for (std::size_t k = pattern_->start[j]; k < pattern_->start[j + 1]; ++k) {
    entries_[k] = difference[static_cast<Eigen::Index>(pattern_->row[k])] / increment;
    finite = finite && std::isfinite(entries_[k]);
  }
  return finite;
}

template <class Scalar>
void RadauSystems::shift(const Scalar& diagonal, Eigen::SparseMatrix<Scalar>& matrix) const {
  Scalar* value = matrix.valuePtr();
  for (std::size_t column = 0; column < pattern_->columns(); ++column) {
    for (std::size_t k = pattern_->start[column]; k < pattern_->start[column + 1]; ++k) {
      value[k] = -entries_[k];
      if (pattern_->row[k] == column) value[k] += diagonal;
    }
  }
}

bool RadauSystems::factorize(const Shifts& shifts) {
  if (pattern_ != nullptr) {
    shift(shifts.real, sparse_real_matrix_);
    sparse_real_.factorize(sparse_real_matrix_);
    if (sparse_real_.info() != Eigen::Success) return false;
    for (std::size_t k = 0; k < pairs_.size(); ++k) {
      shift(shifts.pairs[k], sparse_complex_matrix_);
      pairs_[k].sparse.factorize(sparse_complex_matrix_);
      if (pairs_[k].sparse.info() != Eigen::Success) return false;
    }
    return true;
  }
  real_matrix_ = -jacobian_;
  real_matrix_.diagonal().array() += shifts.real;
  real_.compute(real_matrix_);
  for (std::size_t k = 0; k < pairs_.size(); ++k) {
    complex_matrix_ = -jacobian_.cast<std::complex<double>>();
    complex_matrix_.diagonal().array() += shifts.pairs[k];
    pairs_[k].dense.compute(complex_matrix_);
  }
  return true;
}

void RadauSystems::solve(const Vector& right, Vector& solution) {
  if (pattern_ != nullptr) {
    solution = sparse_real_.solve(right);
  } else {
    solution = real_.solve(right);
  }
}

void RadauSystems::solve(std::size_t pair, const ComplexVector& right, ComplexVector& solution) {
  if (pattern_ != nullptr) {
    solution = pairs_[pair].sparse.solve(right);
  } else {
    solution = pairs_[pair].dense.solve(right);
  }
}

}  // namespace saltus::ode
