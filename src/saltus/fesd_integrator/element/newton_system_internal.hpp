// Linear systems of Newton's method, dense or by their entries.
#pragma once

#include "saltus/fesd_integrator/element/dense_system_internal.hpp"
#include "saltus/fesd_integrator/element/sparse_system_internal.hpp"

namespace saltus::fesd_integrator {

/// Is a dense or a sparse system, as discretization::StagePattern::is_sparse says; the matrix is filled by matrix() or
/// by add().
class NewtonSystem {
 public:
  enum class Storage { dense, sparse };
  /// Makes a system of `most` unknowns at most.
  NewtonSystem(Storage storage, linalg::Index most) : is_sparse_(storage == Storage::sparse) {
    if (!is_sparse_) dense_.reserve(most);
  }
  [[nodiscard]] bool is_sparse() const { return is_sparse_; }
  void reset(linalg::Index n) { is_sparse_ ? sparse_.reset(n) : dense_.reset(n); }
  [[nodiscard]] linalg::View matrix() { return dense_.matrix(); }
  void add(linalg::Index row, linalg::Index column, double value) { sparse_.add(row, column, value); }
  [[nodiscard]] linalg::View right() { return is_sparse_ ? sparse_.right() : dense_.right(); }
  using Unit = DenseSystem::Unit;
  [[nodiscard]] bool solve(double negligible, Unit unit = Unit::right_side) {
    return is_sparse_ ? sparse_.solve(negligible, unit) : dense_.solve(negligible, unit);
  }
  [[nodiscard]] bool is_factorised() const { return is_sparse_ ? sparse_.is_factorised() : dense_.is_factorised(); }
  [[nodiscard]] bool solve_again() { return is_sparse_ ? sparse_.solve_again() : dense_.solve_again(); }
  [[nodiscard]] linalg::Matrix null_space() const { return is_sparse_ ? sparse_.null_space() : dense_.null_space(); }

 private:
  bool is_sparse_;
  DenseSystem dense_;
  SparseSystem sparse_;
};

}  // namespace saltus::fesd_integrator
