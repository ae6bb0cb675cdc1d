// Factorisations of sparse matrices, compiled once.
#pragma once

#include <complex>
#include <memory>
#include <span>
#include <vector>

#include "saltus/linalg/factors.hpp"
#include "saltus/linalg/sparse.hpp"

namespace saltus::linalg {

/// P A Q = L U of a square matrix given by its compressed columns, in an order of few new entries (COLAMD). Real and
/// complex.
template <class Scalar>
class SparseLuOf {
 public:
  /// The places of entries: those of column j are start[j] to start[j + 1] of rows.
  void analyse(std::span<const int> start, std::span<const int> rows);
  /// Of entries at the places that were analysed. False where the matrix is singular.
  [[nodiscard]] bool factorise(std::span<const Scalar> values);
  [[nodiscard]] bool is_factorised() const;
  /// x = A^-1 b; both of the analysed size.
  void solve(std::span<const Scalar> right, std::span<Scalar> solution) const;
  /// Whether a pivot is at most this part of the size of its column. Of real matrices.
  [[nodiscard]] bool has_small_pivot(std::span<const double> column_sizes, double part) const;
  [[nodiscard]] double sign_of_determinant() const;
  [[nodiscard]] double log_abs_determinant() const;
  struct Parts;

 private:
  Hidden<Parts> parts_;
};

extern template class Hidden<SparseLuOf<double>::Parts>;
extern template class Hidden<SparseLuOf<std::complex<double>>::Parts>;
extern template class SparseLuOf<double>;
extern template class SparseLuOf<std::complex<double>>;

/// The same for a matrix of doubles as a whole.
class SparseLu : public SparseLuOf<double> {
 public:
  SparseLu() = default;
  explicit SparseLu(const SparseColumns& a) { static_cast<void>(compute(a)); }
  /// False where it is singular.
  bool compute(const SparseColumns& a);
  void analyse(const SparseColumns& a) { SparseLuOf::analyse(a.start(), a.inner()); }
  [[nodiscard]] bool factorise(const SparseColumns& a) { return SparseLuOf::factorise(a.values()); }
  [[nodiscard]] Matrix solve(ConstView right) const;
};

/// Columns that depend on those before them in an order of few new entries, by a sparse QR with pivots at this
/// threshold.
[[nodiscard]] std::vector<Index> dependent_columns(const SparseColumns& a, double threshold);

/// Vectors x with A x = 0, one for each column that depends on those before it in that order: 1 at this column, 0 at
/// the other dependent ones. Columns of A should be of a similar size. Cost: that of dependent_columns, and of one
/// triangular solution for each vector.
struct NullSpace {
  std::vector<Index> dependent;
  SparseColumns vectors;  ///< columns of A x dependent columns
};
[[nodiscard]] NullSpace null_space(const SparseColumns& a, double threshold);

/// An order of least degree of a square matrix with these places of entries (AMD, of A + A'). A row without a diagonal
/// entry counts as dense and comes last.
[[nodiscard]] std::vector<std::size_t> order_of_least_degree(Index size, std::span<const int> start,
                                                             std::span<const int> rows);

/// P A = L U of a dense complex matrix.
class ComplexLu {
 public:
  /// Of diag(shift) - A.
  void compute_shifted(ConstView a, std::complex<double> shift);
  /// x + i y = A^-1 (b + i c), each of the size of A. Owns its work space: allocates only the first time.
  void solve(ConstView right_real, ConstView right_imaginary, View real, View imaginary);
  struct Parts;

 private:
  Hidden<Parts> parts_;
};

extern template class Hidden<ComplexLu::Parts>;

}  // namespace saltus::linalg
