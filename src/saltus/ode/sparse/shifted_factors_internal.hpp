// Factors of (shift - J) for sparse J of one pattern, real or complex.
#pragma once

#include <cmath>
#include <complex>
#include <cstddef>
#include <memory>
#include <vector>

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <Eigen/SparseLU>

#include "saltus/ode/sparse/elimination.hpp"
#include "saltus/ode/sparse/pattern_matrix_internal.hpp"

namespace saltus::ode {

/// Returns the largest part of a number: no square root as in its absolute value.
inline double largest_part(double value) { return std::abs(value); }
inline double largest_part(const std::complex<double>& value) {
  return std::max(std::abs(value.real()), std::abs(value.imag()));
}
inline double reciprocal(double value) { return 1.0 / value; }
inline std::complex<double> reciprocal(const std::complex<double>& value) {
  return std::conj(value) / std::norm(value);
}

/// Factorizes L U of a matrix with its pivots on the diagonal, row by row: no search, and all places known beforehand.
/// Where a multiplier is beyond `largest_multiplier` the diagonal does not serve, and this matrix has factors with
/// pivots that are searched for (Eigen::SparseLU). Cost: the products of entries; a tenth of those with a search
/// (tridiagonal).
template <class Scalar>
class ShiftedFactors {
 public:
  using Vector = Eigen::Matrix<Scalar, Eigen::Dynamic, 1>;

  /// Uses both, which stay where they are.
  void use(const JacobianPattern& pattern, const Elimination& elimination) {
    pattern_ = &pattern;
    elimination_ = &elimination;
    lower_.resize(elimination.lower.column.size());
    upper_.resize(elimination.upper.column.size());
    reciprocals_.resize(elimination.order.size());
    row_.assign(elimination.order.size(), Scalar(0.0));
    searched_.reset();
  }

  /// Takes the entries of J in the order of the pattern. False where the matrix is singular.
  [[nodiscard]] bool factorize(const std::vector<double>& entries, const Scalar& shift) {
    along_diagonal_ = eliminate(entries, shift);
    return along_diagonal_ || search(entries, shift);
  }

  void solve(const Vector& right, Vector& solution) {
    if (!along_diagonal_) {
      solution = searched_->factors.solve(right);
      return;
    }
    const auto& [order, entries, slot, lower, upper] = *elimination_;
    const std::size_t n = order.size();
    for (std::size_t i = 0; i < n; ++i) {
      Scalar sum = right[static_cast<Eigen::Index>(order[i])];
      for (std::size_t k = lower.start[i]; k < lower.start[i + 1]; ++k) sum -= lower_[k] * row_[lower.column[k]];
      row_[i] = sum;
    }
    for (std::size_t i = n; i-- > 0;) {
      Scalar sum = row_[i];
      for (std::size_t k = upper.start[i]; k < upper.start[i + 1]; ++k) sum -= upper_[k] * row_[upper.column[k]];
      row_[i] = sum * reciprocals_[i];
      solution[static_cast<Eigen::Index>(order[i])] = row_[i];
    }
  }

 private:
  static constexpr double largest_multiplier = 1e3;
  using Matrix = Eigen::SparseMatrix<Scalar>;
  struct Searched {
    Matrix matrix;
    Eigen::SparseLU<Matrix> factors;
  };

  [[nodiscard]] bool eliminate(const std::vector<double>& entries, const Scalar& shift) {
    const auto& [order, places, slot, lower, upper] = *elimination_;
    for (std::size_t i = 0; i < order.size(); ++i) {
      for (std::size_t k = lower.start[i]; k < lower.start[i + 1]; ++k) row_[lower.column[k]] = Scalar(0.0);
      for (std::size_t k = upper.start[i]; k < upper.start[i + 1]; ++k) row_[upper.column[k]] = Scalar(0.0);
      row_[i] = shift;
      for (std::size_t k = places.start[i]; k < places.start[i + 1]; ++k) row_[places.column[k]] -= entries[slot[k]];
      for (std::size_t k = lower.start[i]; k < lower.start[i + 1]; ++k) {
        const std::size_t pivot = lower.column[k];
        const Scalar multiplier = row_[pivot] * reciprocals_[pivot];
        if (!(largest_part(multiplier) <= largest_multiplier)) return false;
        lower_[k] = multiplier;
        for (std::size_t j = upper.start[pivot]; j < upper.start[pivot + 1]; ++j) {
          row_[upper.column[j]] -= multiplier * upper_[j];
        }
      }
      for (std::size_t k = upper.start[i]; k < upper.start[i + 1]; ++k) upper_[k] = row_[upper.column[k]];
      reciprocals_[i] = reciprocal(row_[i]);
      const double size = largest_part(reciprocals_[i]);
      if (!std::isfinite(size) || size == 0.0) return false;
    }
    return true;
  }

  [[nodiscard]] bool search(const std::vector<double>& entries, const Scalar& shift) {
    if (searched_ == nullptr) {
      searched_ = std::make_unique<Searched>();
      searched_->matrix = matrix_of<Scalar>(*pattern_);
      searched_->factors.analyzePattern(searched_->matrix);
    }
    Scalar* const value = searched_->matrix.valuePtr();
    for (std::size_t column = 0; column < pattern_->columns(); ++column) {
      for (std::size_t k = pattern_->start[column]; k < pattern_->start[column + 1]; ++k) {
        const Scalar own = pattern_->row[k] == column ? shift : Scalar(0.0);
        value[k] = own - entries[k];
      }
    }
    searched_->factors.factorize(searched_->matrix);
    return searched_->factors.info() == Eigen::Success;
  }

  const JacobianPattern* pattern_ = nullptr;
  const Elimination* elimination_ = nullptr;
  std::vector<Scalar> lower_, upper_, reciprocals_;
  std::vector<Scalar> row_;  ///< work
  std::unique_ptr<Searched> searched_;
  bool along_diagonal_ = false;
};

}  // namespace saltus::ode
