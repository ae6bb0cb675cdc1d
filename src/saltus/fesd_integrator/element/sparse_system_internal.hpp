// Linear systems of which few entries are other than 0.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "saltus/fesd_integrator/element/dense_system_internal.hpp"
#include "saltus/linalg/matrix.hpp"
#include "saltus/linalg/sparse.hpp"
#include "saltus/linalg/sparse_factors.hpp"

namespace saltus::fesd_integrator {

/// Solves A y = b as DenseSystem does, with A given entry by entry. Systems whose entries come at the same places in
/// the same order are analysed once. Singular ones are solved as dense ones.
class SparseSystem {
 public:
  /// Sets the size, and everything to 0.
  void reset(linalg::Index n);
  /// Adds to an entry of the matrix.
  void add(linalg::Index row, linalg::Index column, double value);
  [[nodiscard]] linalg::View right() { return {right_.data(), right_.size()}; }
  /// Does what DenseSystem::solve does. Cost: that of the factors of a sparse matrix; n^3 where it is singular.
  [[nodiscard]] bool solve(double negligible, DenseSystem::Unit unit);
  [[nodiscard]] bool is_factorised() const { return factorised_ || dense_.is_factorised(); }
  [[nodiscard]] bool solve_again();
  [[nodiscard]] linalg::Matrix null_space() const;

 private:
  void analyse();
  [[nodiscard]] bool take_entries();
  [[nodiscard]] bool factorise();
  [[nodiscard]] bool solve_dense(double negligible, DenseSystem::Unit unit);

  using Place = std::pair<linalg::Index, linalg::Index>;
  std::vector<Place> places_;      ///< of what is added, in turn
  std::vector<double> given_;      ///< what is added
  std::vector<std::size_t> slot_;  ///< where in the matrix
  std::size_t next_ = 0;
  bool analysed_ = false, factorised_ = false;
  bool is_diagonal_ = false;  ///< as where sliding surfaces do not influence each other
  linalg::SparseColumns matrix_;
  linalg::Vector right_, solution_, column_sizes_;
  linalg::SparseLu factors_;
  DenseSystem dense_;  ///< of the last system, if that was singular
};

}  // namespace saltus::fesd_integrator
