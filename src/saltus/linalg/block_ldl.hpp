// Factors of sparse symmetric matrices whose rows fall into blocks that are eliminated one after the other.
#pragma once

#include <span>
#include <vector>

#include "saltus/linalg/factors.hpp"

namespace saltus::linalg {

/// Holds how many eigenvalues of a symmetric matrix have which sign.
struct Inertia {
  int positive = 0, negative = 0, zero = 0;
  [[nodiscard]] bool operator==(const Inertia&) const = default;
};

/// P S A S P' = L D L' of a sparse symmetric indefinite matrix, by fronts [duff1983]: one dense front per block of rows
/// that are eliminated together, from the first block to the last. S has powers of 2 and makes the largest entries of
/// rows about 1. Pivots of one or two rows are chosen by a threshold against all of their column [duff1986]; rows that
/// have none in their block are delayed to the next block that theirs meets. Same values, same bits.
/// Cost: for a chain of N blocks of m rows that each meets b rows behind it, N m (m + b)^2. Once one matrix has been
/// factorised, the next ones and solutions allocate nothing, unless more rows than ever are delayed.
class BlockLdl {
 public:
  /// Pivots of this part of their column are exact enough where solutions are refined.
  static constexpr double usual_tolerance = 1e-6;

  /// The places of entries of one triangle (in any order; those of one place are added), and the block of each row:
  /// blocks are eliminated by increasing number. Numbers without a row are allowed.
  void analyse(Index size, std::span<const int> rows, std::span<const int> columns, std::span<const int> block);
  /// Of the values of these entries. A pivot is at least this part (at most 0.5) of the entries in its column: a
  /// larger one costs delayed rows, and makes more exact factors.
  Inertia factorise(std::span<const double> values, double pivot_tolerance = usual_tolerance);
  /// x = A^-1 x. The rows without pivots, if there are any, get 0.
  void solve(std::span<double> x);

  /// The rows that the last factorisation found no pivot for: as many as Inertia::zero, in increasing order.
  [[nodiscard]] std::span<const int> rows_without_pivot() const;
  /// The number of rows that the last factorisation delayed, each as often as it was.
  [[nodiscard]] long delayed_rows() const;
  /// Multiplications of the last factorisation, not counting those of assembly.
  [[nodiscard]] double multiplications() const;
  struct Parts;

 private:
  Hidden<Parts> parts_;
};

extern template class Hidden<BlockLdl::Parts>;

}  // namespace saltus::linalg
