// Factors of (shift - J) for sparse J of one pattern, real or complex, with pivots where they are needed.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <Eigen/SparseLU>

#include "saltus/ode/sparse/diagonal_factors_internal.hpp"
#include "saltus/ode/sparse/pattern_matrix_internal.hpp"

namespace saltus::ode {

/// Factorizes with pivots on the diagonal or, where that does not serve, with pivots that are searched for
/// (Eigen::SparseLU).
template <class Scalar>
class ShiftedFactors {
 public:
  using Vector = Eigen::Matrix<Scalar, Eigen::Dynamic, 1>;

  /// Uses both, which stay where they are.
  void use(const JacobianPattern& pattern, const Elimination& elimination) {
    pattern_ = &pattern;
    diagonal_.use(elimination);
    searched_.reset();
  }

  /// Takes the entries of J in the order of the pattern. False where the matrix is singular.
  [[nodiscard]] bool factorize(const std::vector<double>& entries, const Scalar& shift) {
    along_diagonal_ = diagonal_.factorize(entries, shift);
    return along_diagonal_ || search(entries, shift);
  }

  void solve(const Vector& right, Vector& solution) {
    if (!along_diagonal_) {
      solution = searched_->factors.solve(right);
      return;
    }
    diagonal_.solve([&](std::size_t i) { return right[static_cast<Eigen::Index>(i)]; },
                    [&](std::size_t i, const Scalar& value) { solution[static_cast<Eigen::Index>(i)] = value; });
  }

 private:
  using Matrix = Eigen::SparseMatrix<Scalar>;
  struct Searched {
    Matrix matrix;
    Eigen::SparseLU<Matrix> factors;
  };

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
  DiagonalFactors<Scalar> diagonal_;
  std::unique_ptr<Searched> searched_;
  bool along_diagonal_ = false;
};

}  // namespace saltus::ode
