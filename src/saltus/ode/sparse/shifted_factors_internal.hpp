// Factors of (shift - J) for sparse J of one pattern, real or complex, with pivots where they are needed.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "saltus/base/at.hpp"
#include "saltus/linalg/sparse_factors.hpp"
#include "saltus/ode/sparse/diagonal_factors_internal.hpp"
#include "saltus/ode/sparse/pattern_places_internal.hpp"

namespace saltus::ode {

/// Factorizes with pivots on the diagonal or, where that does not serve, with pivots that are searched for.
template <class Scalar>
class ShiftedFactors {
 public:
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

  /// Both of as many numbers as there are columns.
  void solve(std::span<const Scalar> right, std::span<Scalar> solution) {
    if (!along_diagonal_) return searched_->factors.solve(right, solution);
    diagonal_.solve([&](std::size_t i) { return right[i]; },
                    [&](std::size_t i, const Scalar& value) { solution[i] = value; });
  }

 private:
  struct Searched {
    std::vector<Scalar> values;  ///< of shift - J, in the order of the pattern
    linalg::SparseLuOf<Scalar> factors;
  };

  [[nodiscard]] bool search(const std::vector<double>& entries, const Scalar& shift) {
    if (searched_ == nullptr) {
      searched_ = std::make_unique<Searched>();
      searched_->values.resize(pattern_->row.size());
      const PatternPlaces places(*pattern_);
      searched_->factors.analyse(places.start, places.row);
    }
    for (std::size_t column = 0; column < pattern_->columns(); ++column) {
      for (std::size_t k = pattern_->start[column]; k < pattern_->start[column + 1]; ++k) {
        const Scalar own = pattern_->row[k] == column ? shift : Scalar(0.0);
        searched_->values[k] = own - entries[k];
      }
    }
    return searched_->factors.factorise(searched_->values);
  }

  const JacobianPattern* pattern_ = nullptr;
  DiagonalFactors<Scalar> diagonal_;
  std::unique_ptr<Searched> searched_;
  bool along_diagonal_ = false;
};

}  // namespace saltus::ode
