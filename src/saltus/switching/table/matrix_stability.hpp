// Stability of small matrices, as they are and up to a scaling of their rows.
#pragma once

#include <span>
#include <vector>

namespace saltus::switching {

/// Holds the LU factors with row exchanges of an n x n matrix, row by row; refilled without allocation.
class LuFactors {
 public:
  explicit LuFactors(int n);
  /// Factors a matrix.
  /// @return false if the matrix is singular to working precision: solve is then not to be called
  bool factor(std::span<const double> matrix);
  void solve(double* b) const;  ///< b := A^-1 b, n doubles
  [[nodiscard]] double determinant() const { return determinant_; }

 private:
  int n_;
  double determinant_ = 0.0;
  std::vector<double> lu_;
  std::vector<int> pivot_;
};

/// Returns whether all eigenvalues of A (n x n, row by row) have negative real parts, by more than rounding: n <= 2 by
/// trace and determinant, else powers of the Cayley transform (I - hA)^-1 (I + hA), which tend to 0 exactly then. Cost:
/// some 30 products of matrices; allocates.
[[nodiscard]] bool is_hurwitz(std::span<const double> matrix, int n);

/// Returns a number that is positive exactly if all eigenvalues of A (n x n, row by row) have negative real parts: the
/// least leading Hurwitz determinant of det(s I - A / |A|) (Routh and Hurwitz). A polynomial of A / |A|, so that an
/// event can be located where it passes 0: a complex pair crosses the imaginary axis, or an eigenvalue 0. Cost: n^4
/// operations; allocates.
[[nodiscard]] double hurwitz_margin(std::span<const double> matrix, int n);

/// Returns a number that is positive only if some positive diagonal D makes DA stable (all eigenvalues in the left half
/// plane):
///   max over orderings of the indices, min over k, of the k-th leading principal minor of -A in that ordering,
/// the rows of A being divided by their largest entries first ([fisher1958]). For n = 2 it is positive exactly if
/// det A > 0 and min(A11, A22) < 0, which is (4.12) of [guglielmi2022]; for n >= 3 this is sufficient.
///
/// Continuous in A, so that an event can be located where it passes 0; invariant under positive scaling of rows.
/// Cost: 2^n minors for n <= 10; beyond that the ordering is built greedily (a lower bound of the maximum).
/// Allocates 2^n doubles for n > 4.
[[nodiscard]] double fisher_fuller_margin(std::span<const double> matrix, int n);

}  // namespace saltus::switching
