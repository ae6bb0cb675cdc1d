// The linear systems of the iterations of Radau methods: dense, or sparse where the Jacobian has few entries.
#pragma once

#include <array>
#include <complex>
#include <cstddef>
#include <vector>

#include "saltus/linalg/factors.hpp"
#include "saltus/linalg/matrix.hpp"
#include "saltus/linalg/sparse_factors.hpp"
#include "saltus/ode/sparse/jacobian_pattern.hpp"
#include "saltus/ode/sparse/shifted_factors_internal.hpp"

namespace saltus::ode {

/// Solves (real / h - J) x = b and ((re + i im) / h - J) x = b, one of these for each pair of eigenvalues. The sparse
/// ones are analysed once per pattern, and all of them are solved in one pass; all storage is kept.
template <std::size_t pairs>
class RadauSystems {
 public:
  using Vector = linalg::Vector;
  using Matrix = linalg::Matrix;
  struct Shifts {
    double real;
    std::array<std::complex<double>, pairs> complex;
  };

  explicit RadauSystems(linalg::Index n) : n_(n) {}

  /// Takes the pattern; null: dense. The same address is the same pattern. Returns whether it is another one than
  /// before, whose Jacobian and factors are not known.
  bool use(const JacobianPattern* pattern);
  [[nodiscard]] bool is_sparse() const { return pattern_ != nullptr; }
  /// Returns columns that one difference serves together; empty where the matrix is dense.
  [[nodiscard]] const std::vector<std::vector<std::size_t>>& groups() const { return groups_; }

  /// Returns the entries of J, in the order of the pattern or column by column.
  [[nodiscard]] double* entries() { return pattern_ != nullptr ? entries_.data() : jacobian_.data(); }
  [[nodiscard]] bool all_finite() const;  ///< of J
  /// Sets column j of J from the difference of slopes that its group gives; false where an entry is not finite.
  [[nodiscard]] bool set_column(linalg::Index column, const Vector& difference, double increment);
  /// Computes the product of J and a vector.
  void multiply(const Vector& x, Vector& product) const;
  /// Factorizes; returns false where a matrix is singular.
  [[nodiscard]] bool factorize(const Shifts& shifts);
  /// Solves the real one.
  void solve(linalg::ConstView right, linalg::View solution);
  /// Solves all of them. Columns: the real one, then real and imaginary part of each other one.
  void solve_all(const Matrix& right, Matrix& solution);

 private:
  using Joint = JointNumber<pairs>;
  void solve_joint(const Matrix& right, Matrix& solution);
  void find_still_rows();

  linalg::Index n_;
  const JacobianPattern* pattern_ = nullptr;
  bool started_ = false;
  std::vector<std::vector<std::size_t>> groups_;
  // Dense.
  Matrix jacobian_, real_matrix_;
  linalg::Lu real_;
  // Sparse: entries of J in the order of the pattern.
  std::vector<double> entries_;
  Elimination elimination_;
  DiagonalFactors<Joint> joint_;
  bool along_diagonal_ = false;  ///< joint_ holds all of them; otherwise each has factors of its own
  std::vector<bool> still_;      ///< by row: it is 0 in J, where pivots are searched for
  ShiftedFactors<double> sparse_real_;
  struct Pair {
    linalg::ComplexLu dense;
    ShiftedFactors<std::complex<double>> sparse;
  };
  std::array<Pair, pairs> pairs_;
  std::vector<std::complex<double>> complex_part_, complex_solution_;
};

}  // namespace saltus::ode
