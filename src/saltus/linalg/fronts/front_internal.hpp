// A dense symmetric matrix some of whose rows are eliminated: the inner loops of BlockLdl.
#pragma once

#include <cstddef>

namespace saltus::linalg::fronts {

/// Rows that the loops handle at once; the stride of a front is a multiple.
inline constexpr int tile_rows = 8;
inline constexpr int tile_columns = 4;
/// Pivots whose updates of later columns are made together.
inline constexpr int panel_pivots = 12;

/// Holds the inverse of a pivot: of one row, or with the next pivot that of two, where `below` is not 0.
struct Pivot {
  double diagonal, below;
};

/// Refers to the lower triangle of a matrix, column by column. Behind its rows up to the stride there are zeros, and
/// behind its columns room for tile_columns more.
struct Front {
  double* entries;
  int stride;
  int size;
  int candidates;  ///< the first rows: those that may be eliminated
  int* rows;       ///< what the caller calls each row: exchanged with it
  Pivot* pivots;   ///< one per candidate

  [[nodiscard]] double* column(int j) const {
    return entries + static_cast<std::ptrdiff_t>(j) * static_cast<std::ptrdiff_t>(stride);
  }
};

/// Holds what the loops need beside a front: panel_columns() columns of its stride and tile_columns more.
struct FrontWork {
  double* columns;

  [[nodiscard]] static constexpr int panel_columns() { return panel_pivots + 3; }
};

struct Eliminated {
  int pivots = 0;
  int negative = 0;  ///< eigenvalues of the pivots
};

/// What may be a pivot.
struct PivotRule {
  double tolerance;  ///< least part of the largest entry in its column
  double smallest;   ///< entries of this size are 0
};

/// Writes L (with ones in its diagonal) over the columns of as many candidates as have a pivot, which come first then,
/// and the Schur complement over the rest. A pivot is one row or two, chosen against all of its column.
/// [duff1986], chapter 5. Cost: pivots * size^2.
Eliminated eliminate(const Front& front, const FrontWork& work, PivotRule rule);

/// Solves with the factors of the first `pivots` rows: x becomes L^-1 x; the rows behind them are updated.
void solve_forward(const Front& front, int pivots, double* x);
/// x becomes L'^-1 D^-1 x.
void solve_backward(const Front& front, int pivots, double* x);

}  // namespace saltus::linalg::fronts
