// Factors of a symmetric positive definite matrix of expressions.
#pragma once

#include <utility>
#include <vector>

#include <casadi/core/sx.hpp>
#include <casadi/core/sx_elem.hpp>

namespace saltus::model {

/// Holds M = L D L', L with ones on its diagonal: no square roots, no pivots, and no operation on an entry that is 0.
/// Cost: linear in the entries of M and in the products that L is made of.
class SymbolicLdl {
 public:
  /// @param m       n x n, sparse or dense; its lower triangle is read
  /// @param moving  symbols of which a pivot may not be positive everywhere
  SymbolicLdl(const casadi::SX& m, const casadi::SX& moving);

  /// Returns M^-1 B, which is not finite where a pivot is negative. @param right  n x k
  [[nodiscard]] casadi::SX solve(const casadi::SX& right) const;
  /// Returns M^-1 f, which is no number where a pivot is negative, though nothing may be divided by it.
  [[nodiscard]] casadi::SX accelerations(const casadi::SX& force) const;
  /// Returns the entries of D: M is positive definite where all are positive.
  [[nodiscard]] const std::vector<casadi::SXElem>& pivots() const { return pivots_; }
  /// Returns the number of entries of L below its diagonal.
  [[nodiscard]] std::size_t entries_below() const;

 private:
  [[nodiscard]] casadi::SX solve(const casadi::SX& right, const std::vector<casadi::SXElem>& zeros) const;

  using Entries = std::vector<std::pair<casadi_int, casadi::SXElem>>;  ///< ascending
  std::vector<Entries> rows_, columns_;                                ///< of L, below the diagonal
  std::vector<casadi::SXElem> pivots_;
  std::vector<casadi::SXElem> divisors_;  ///< no number where a pivot is negative
  std::vector<casadi::SXElem> zeros_;     ///< 0, and likewise
};

enum class Symmetry { none, symmetric };

/// Solves A^-1 b by elimination in the order of the rows: for matrices whose leading minors are not 0.
/// @param matrix  n x n; of a symmetric one the upper triangle is read, and half the operations do
/// @param right   n x 1
[[nodiscard]] casadi::SX eliminate(const casadi::SX& matrix, const casadi::SX& right, Symmetry symmetry);

}  // namespace saltus::model
