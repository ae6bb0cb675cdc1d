// Gradients of the sliding surfaces as sparse rows, and the normal equations J J^T z = r by their components.
#pragma once

#include <cstddef>
#include <vector>

#include "saltus/linalg/factors.hpp"
#include "saltus/linalg/matrix.hpp"
#include "saltus/linalg/sparse_factors.hpp"

namespace saltus::event_integrator {

/// Holds from how many rows on a sparse factorisation costs less than a dense one.
inline constexpr std::size_t sparse_from = 16;

/// Holds the entries of a gradient that are not 0, by ascending column.
struct SparseRow {
  std::vector<std::size_t> column;
  std::vector<double> value;

  /// Returns the only column, or -1.
  [[nodiscard]] int only() const { return column.size() == 1 ? static_cast<int>(column.front()) : -1; }
  [[nodiscard]] double dot(const std::vector<double>& f, double sum) const {
    for (std::size_t k = 0; k < column.size(); ++k) sum += value[k] * f[column[k]];
    return sum;
  }
};

/// Solves the normal equations of rows. Rows that share a column, directly or through others, are solved together; all
/// others by themselves. Cost of a solution: O(1) for each of those, and for a component of c > 1 rows c^3; from 16
/// rows on that of a sparse factorisation of J J^T, c times the square of its bandwidth. A copy has to be given its
/// rows anew.
class NormalRows {
 public:
  void resize(std::size_t rows, std::size_t columns);
  /// Takes entries that stay where and what they are, of this size.
  void set(std::size_t row, const SparseRow& entries, double size);
  /// Takes entries that may change or move.
  void copy(std::size_t row, const SparseRow& entries, double size);
  void set(std::size_t row, const std::vector<double>& dense);
  [[nodiscard]] const SparseRow& operator[](std::size_t row) const { return *rows_[row]; }
  [[nodiscard]] double size(std::size_t row) const { return size_[row]; }

  /// Solves J J^T z = r for z, in place; false where the rows of a component depend on each other.
  [[nodiscard]] bool solve(linalg::Vector& residual);
  /// Takes J^T z from x (columns); returns whether that has changed it. Cost: the entries of all rows.
  bool subtract_transposed(const linalg::Vector& z, double* x);
  /// Takes from x the least d of J d = r: a Newton step onto functions of these gradients and values. Multipliers take
  /// the place of r. Returns whether x changed: not where rows depend on each other, or r is not finite.
  bool correct(linalg::Vector& residual, double* x);

 private:
  /// Rows that are solved together.
  struct Component {
    std::vector<std::size_t> rows;
    /// Of many rows: J J^T by its columns, from start[j] to start[j + 1] of inner, and its factors.
    std::vector<int> start = {}, inner = {};
    std::vector<double> values = {}, size = {};
    linalg::SparseLuOf<double> factors = {};
  };
  void find_components();
  void find_pattern(Component& component) const;
  [[nodiscard]] bool solve_component(Component& component, linalg::Vector& residual);
  [[nodiscard]] bool solve_dense(const std::vector<std::size_t>& rows);
  [[nodiscard]] bool solve_sparse(Component& component);
  [[nodiscard]] double product(std::size_t a, std::size_t b) const;

  std::size_t columns_ = 0;
  std::vector<const SparseRow*> rows_;  ///< of own_, or of somebody else
  std::vector<SparseRow> own_;
  std::vector<double> size_;  ///< |row|
  bool components_known_ = false;
  std::vector<std::size_t> alone_;   ///< rows that share no column
  std::vector<Component> together_;  ///< the other components
  std::vector<std::size_t> first_of_column_;
  std::vector<double> sum_;  ///< columns, 0 between two calls
  linalg::Matrix matrix_;
  linalg::Vector part_;  ///< of a residual, and its solution
  std::vector<double> right_;
  linalg::Cholesky cholesky_;
};

}  // namespace saltus::event_integrator
