// The loops of front_internal.hpp, to be compiled for several processors: everything is inlined into who calls it.
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>

#include "saltus/linalg/fronts/front_internal.hpp"

#define SALTUS_INLINE [[gnu::always_inline]] inline

namespace saltus::linalg::fronts::loops {

/// Four numbers side by side, where the compiler would not find that they may be: it does not change the order in which
/// numbers are compared or added, and mixes up rows and columns of a tile.
using Four [[gnu::vector_size(4 * sizeof(double)), gnu::aligned(alignof(double)), gnu::may_alias]] = double;
using FourBits [[gnu::vector_size(4 * sizeof(double)), gnu::aligned(alignof(double)), gnu::may_alias]] = long long;
inline constexpr int lanes = 4;

SALTUS_INLINE const Four& four(const double* x) { return *reinterpret_cast<const Four*>(x); }
SALTUS_INLINE Four& four(double* x) { return *reinterpret_cast<Four*>(x); }

/// The largest absolute value of the entries from `first` to before `last`. What is not a number is left out.
SALTUS_INLINE double largest(const double* x, int first, int last) {
  constexpr long long all_but_sign = 0x7fffffffffffffffLL;
  constexpr FourBits mask = {all_but_sign, all_but_sign, all_but_sign, all_but_sign};
  Four found = {}, more = {};
  int i = first;
  for (; i + 2 * lanes <= last; i += 2 * lanes) {
    const Four a = reinterpret_cast<Four>(reinterpret_cast<const FourBits&>(four(x + i)) & mask);
    const Four b = reinterpret_cast<Four>(reinterpret_cast<const FourBits&>(four(x + i + lanes)) & mask);
    found = a > found ? a : found;
    more = b > more ? b : more;
  }
  found = found > more ? found : more;
  double size = std::max(std::max(found[0], found[1]), std::max(found[2], found[3]));
  for (; i < last; ++i) size = std::max(size, std::abs(x[i]));
  return size;
}

/// x -= sum over q of factors[q] * columns[q * stride] for the entries from `first` to before `last`.
SALTUS_INLINE void subtract_columns(double* __restrict x, int first, int last, const double* columns,
                                    std::ptrdiff_t stride, const double* factors, int count) {
  int q = 0;
  for (; q + 4 <= count; q += 4) {
    const double *a = columns + q * stride, *b = a + stride, *c = b + stride, *d = c + stride;
    const double fa = factors[q], fb = factors[q + 1], fc = factors[q + 2], fd = factors[q + 3];
    for (int i = first; i < last; ++i) x[i] -= (a[i] * fa + b[i] * fb) + (c[i] * fc + d[i] * fd);
  }
  for (; q < count; ++q) {
    const double* a = columns + q * stride;
    const double fa = factors[q];
    for (int i = first; i < last; ++i) x[i] -= a[i] * fa;
  }
}

/// One tile of a panel's update C -= L W'.
SALTUS_INLINE void update_tile(double* c, std::ptrdiff_t stride, const double* l, const double* w,
                               std::ptrdiff_t w_stride, int count) {
  Four upper[tile_columns], lower[tile_columns];
  for (int j = 0; j < tile_columns; ++j) {
    upper[j] = four(c + j * stride);
    lower[j] = four(c + j * stride + lanes);
  }
  for (int q = 0; q < count; ++q, l += stride, w += w_stride) {
    const Four a = four(l), b = four(l + lanes);
    for (int j = 0; j < tile_columns; ++j) {
      upper[j] -= a * w[j];
      lower[j] -= b * w[j];
    }
  }
  for (int j = 0; j < tile_columns; ++j) {
    four(c + j * stride) = upper[j];
    four(c + j * stride + lanes) = lower[j];
  }
}

/// Eliminates the candidates of one front.
struct Elimination {
  const Front& front;
  PivotRule rule;
  std::ptrdiff_t stride, panel_stride;
  double *panel, *x, *y, *factors;  ///< D L' of the pivots not yet applied; columns of two candidates
  int done = 0, applied = 0;        ///< pivots; those of them that later columns know of
  int negative = 0;
  double inside = 0.0, outside = 0.0;  ///< largest entries of a column beside its diagonal: candidates, other rows

  SALTUS_INLINE Elimination(const Front& of, const FrontWork& work, PivotRule with)
      : front(of),
        rule(with),
        stride(of.stride),
        panel_stride(of.stride + tile_columns),
        panel(work.columns),
        x(panel + panel_stride * panel_pivots),
        y(x + panel_stride),
        factors(y + panel_stride) {}

  /// Column j as it is behind all pivots, in the places of its rows.
  SALTUS_INLINE void find_column(int j, double* to) const {
    const int begin = done - done % tile_rows;
    for (int i = begin; i < done; ++i) to[i] = 0.0;
    for (int i = done; i < j; ++i) to[i] = front.column(i)[j];
    const double* const from = front.column(j);
    for (int i = j; i < front.stride; ++i) to[i] = from[i];
    for (int q = 0; q < done - applied; ++q) factors[q] = panel[q * panel_stride + j];
    subtract_columns(to, begin, front.stride, front.column(applied), stride, factors, done - applied);
    for (int i = begin; i < done; ++i) to[i] = 0.0;
  }

  /// The largest entry beside those of two rows.
  SALTUS_INLINE double largest_beside(double* column, int i, int j) const {
    const double kept_i = std::exchange(column[i], 0.0), kept_j = std::exchange(column[j], 0.0);
    const double size = largest(column, done, front.size);
    column[j] = kept_j;
    column[i] = kept_i;
    return size;
  }

  /// Exchanges two rows and their columns, done <= i < j.
  SALTUS_INLINE void exchange(int i, int j) {
    if (i == j) return;
    for (int q = 0; q < i; ++q) std::swap(front.column(q)[i], front.column(q)[j]);
    for (int q = 0; q < done - applied; ++q) std::swap(panel[q * panel_stride + i], panel[q * panel_stride + j]);
    double *const a = front.column(i), *const b = front.column(j);
    std::swap(a[i], b[j]);
    for (int q = i + 1; q < j; ++q) std::swap(a[q], front.column(q)[j]);
    for (int q = j + 1; q < front.size; ++q) std::swap(a[q], b[q]);
    std::swap(front.rows[i], front.rows[j]);
    std::swap(x[i], x[j]);
    std::swap(y[i], y[j]);
  }

  SALTUS_INLINE void accept_one(int c) {
    exchange(done, c);
    const double pivot = x[done], inverse = 1.0 / pivot;
    front.pivots[done] = {inverse, 0.0};
    negative += pivot < 0.0 ? 1 : 0;
    double *const w = panel + (done - applied) * panel_stride, *const l = front.column(done);
    for (int i = done + 1; i < front.stride; ++i) {
      w[i] = x[i];
      l[i] = x[i] * inverse;
    }
    l[done] = 1.0;
    ++done;
  }

  SALTUS_INLINE void accept_two(int c, int r) {
    exchange(done, c);
    exchange(done + 1, r == done ? c : r);
    const int k = done;
    const double a = x[k], b = x[k + 1], d = y[k + 1], determinant = a * d - b * b;
    const double ia = d / determinant, ib = -b / determinant, id = a / determinant;
    front.pivots[k] = {ia, ib};
    front.pivots[k + 1] = {id, 0.0};
    negative += determinant < 0.0 ? 1 : (a + d < 0.0 ? 2 : 0);
    double *const w = panel + (k - applied) * panel_stride, *const v = w + panel_stride;
    double *const l = front.column(k), *const m = l + stride;
    for (int i = k + 2; i < front.stride; ++i) {
      const double p = x[i], q = y[i];
      w[i] = p;
      v[i] = q;
      l[i] = p * ia + q * ib;
      m[i] = p * ib + q * id;
    }
    l[k] = m[k + 1] = 1.0;
    l[k + 1] = 0.0;
    done += 2;
  }

  /// Whether candidate c, whose column is in x, is a pivot; and if it is, eliminates it.
  SALTUS_INLINE bool try_one(int c) {
    const double diagonal = x[c];
    inside = std::max(largest(x, done, c), largest(x, c + 1, front.candidates));
    outside = largest(x, front.candidates, front.size);
    const double size = std::abs(diagonal);
    if (!(size > rule.smallest) || size < rule.tolerance * std::max(inside, outside)) return false;
    accept_one(c);
    return true;
  }

  /// The same with the candidate of its largest entry as a pivot of two rows.
  SALTUS_INLINE bool try_two(int c) {
    if (!(inside > rule.smallest)) return false;
    int r = done;
    while (r == c || std::abs(x[r]) != inside) ++r;
    find_column(r, y);
    const double a = std::abs(x[c]), b = std::abs(x[r]), d = std::abs(y[r]);
    const double determinant = std::abs(x[c] * y[r] - x[r] * x[r]);
    // Where the product and the square cancel, the partner alone is the pivot.
    constexpr double cancelled = 1e-3;
    if (!(determinant > cancelled * std::max(a * d, b * b))) return false;
    const double beside_c = largest_beside(x, c, r), beside_r = largest_beside(y, c, r);
    const double limit = determinant / rule.tolerance;
    if (d * beside_c + b * beside_r > limit || b * beside_c + a * beside_r > limit) return false;
    accept_two(c, r);
    return true;
  }

  /// Tells all later columns of the pivots found since the last time.
  SALTUS_INLINE void apply_panel() {
    const int count = done - applied;
    const double* const l = front.column(applied);
    for (int j = done; j < front.size && count > 0; j += tile_columns) {
      for (int i = j - j % tile_rows; i < front.stride; i += tile_rows) {
        update_tile(front.column(j) + i, stride, l + i, panel + j, panel_stride, count);
      }
    }
    applied = done;
  }

  /// Goes through the candidates until none of those that are left is a pivot.
  SALTUS_INLINE Eliminated run() {
    for (int before = -1; before < done && done < front.candidates;) {
      before = done;
      for (int c = done; c < front.candidates;) {
        if (done - applied >= panel_pivots - 1) apply_panel();
        find_column(c, x);
        const bool is_pivot = try_one(c) || try_two(c);
        c = is_pivot ? std::max(c + 1, done) : c + 1;
      }
    }
    apply_panel();
    return {done, negative};
  }
};

SALTUS_INLINE void forward(const Front& front, int pivots, double* x) {
  constexpr int width = 4;
  const std::ptrdiff_t stride = front.stride;
  int k = 0;
  for (; k + width <= pivots; k += width) {
    for (int q = k; q < k + width; ++q) {
      const double* const l = front.column(q);
      for (int i = q + 1; i < k + width; ++i) x[i] -= l[i] * x[q];
    }
    const double factors[width] = {x[k], x[k + 1], x[k + 2], x[k + 3]};
    subtract_columns(x, k + width, front.size, front.column(k), stride, factors, width);
  }
  for (; k < pivots; ++k) {
    const double factor = x[k];
    subtract_columns(x, k + 1, front.size, front.column(k), stride, &factor, 1);
  }
}

/// x[k + q] -= sum over i of L(i, k + q) x[i] for the rows from `first` on, `width` columns at once.
template <int width>
SALTUS_INLINE void subtract_products(const Front& front, int k, int first, double* x) {
  Four sum[static_cast<std::size_t>(width)] = {};
  const double* const l = front.column(k);
  const std::ptrdiff_t stride = front.stride;
  int i = first;
  for (; i + lanes <= front.size; i += lanes) {
    const Four factor = four(static_cast<const double*>(x) + i);
    for (int q = 0; q < width; ++q) sum[q] += four(l + q * stride + i) * factor;
  }
  for (; i < front.size; ++i) {
    for (int q = 0; q < width; ++q) sum[q][0] += l[q * stride + i] * x[i];
  }
  for (int q = 0; q < width; ++q) x[k + q] -= (sum[q][0] + sum[q][1]) + (sum[q][2] + sum[q][3]);
}

SALTUS_INLINE void backward(const Front& front, int pivots, double* x) {
  constexpr int width = 4;
  for (int k = 0; k < pivots; ++k) {
    const auto [diagonal, below] = front.pivots[k];
    if (below == 0.0) {
      x[k] *= diagonal;
      continue;
    }
    const double a = x[k], b = x[k + 1];
    x[k] = diagonal * a + below * b;
    x[k + 1] = below * a + front.pivots[k + 1].diagonal * b;
    ++k;
  }
  int k = pivots;
  for (; k % width != 0; --k) subtract_products<1>(front, k - 1, k, x);
  for (k -= width; k >= 0; k -= width) {
    subtract_products<width>(front, k, k + width, x);
    for (int q = k + width - 1; q > k; --q) {
      for (int i = k; i < q; ++i) x[i] -= front.column(i)[q] * x[q];
    }
  }
}

}  // namespace saltus::linalg::fronts::loops
