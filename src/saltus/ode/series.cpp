#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "saltus/ode/bernstein_internal.hpp"
#include "saltus/ode/explicit/lanes_internal.hpp"
#include "saltus/ode/series_internal.hpp"
#include "saltus/ode/step_checks_internal.hpp"

namespace saltus::ode {
namespace {

constexpr std::size_t degree = series_degree;

/// The power of two below |h|, which gives powers of h / unit no chance to overflow; h != 0.
double power_of_two_below(double h) {
  constexpr std::uint64_t exponent = 0x7ff0'0000'0000'0000;
  return std::max(std::bit_cast<double>(std::bit_cast<std::uint64_t>(h) & exponent),
                  std::numeric_limits<double>::min());
}

/// 1 / k.
constexpr auto inverse = [] {
  std::array<double, degree + 1> row{};
  for (std::size_t k = 1; k <= degree; ++k) row[k] = 1.0 / static_cast<double>(k);
  return row;
}();

Pair both(double value) { return Pair{value, value}; }
/// Term k of a pair of components.
Pair term_of(const double* pair, std::size_t k) { return load<Pair>(pair + 2 * k); }

/// Components i and i + 1 of a vector of n, 0 behind its end.
Pair load_pair(const double* x, std::size_t n, std::size_t i) {
  return i + 1 < n ? load<Pair>(x + i) : Pair{x[i], 0.0};
}
void store_pair(double* x, std::size_t n, std::size_t i, Pair value) {
  if (i + 1 < n) return store(x + i, value);
  x[i] = value[0];
}

/// Terms 2, 3, ... from term 1, for so few pairs of components that A is one register after the other, zeros and all:
/// rows of different lengths cost more.
template <std::size_t pairs>
void multiply_few(const LinearField& field, double* scaled, double unit) {
  const std::size_t n = field.diagonal.size();
  Pair columns[2 * pairs][pairs] = {};
  for (std::size_t i = 0; i < n; ++i) {
    columns[i][i / 2][i % 2] = field.diagonal[i];
    for (std::size_t k = field.start[i]; k < field.start[i + 1]; ++k)
      columns[field.column[k]][i / 2][i % 2] = field.entry[k];
  }
  Pair current[pairs];
  for (std::size_t p = 0; p < pairs; ++p) current[p] = term_of(scaled + p * series_stride, 1);
  for (std::size_t k = 2; k <= degree; ++k) {
    Pair next[pairs] = {};
    for (std::size_t j = 0; j < 2 * pairs; ++j) {
      const Pair value = both(current[j / 2][j % 2]);
      for (std::size_t p = 0; p < pairs; ++p) next[p] += columns[j][p] * value;
    }
    const double scale = unit * inverse[k];
    for (std::size_t p = 0; p < pairs; ++p) {
      current[p] = scale * next[p];
      if (k == 2 && !field.rate.empty()) current[p] += 0.5 * unit * unit * load_pair(field.rate.data(), n, 2 * p);
      store(scaled + p * series_stride + 2 * k, current[p]);
    }
  }
}

/// Bounds of polynomials by the Bernstein coefficients of their first terms and the sizes of the rest: theirs of all
/// terms cost three times as much, and what is left out is small in steps that are accurate.
constexpr std::size_t bound_degree = 8;

struct Range {
  Pair low, high;
};

/// Least and largest values on [0, 1] of the polynomials of terms first, first + 1, ... of a pair.
template <std::size_t first>
Range range(const double* pair) {
  static constexpr auto share = inverse_binomials<bound_degree>();
  std::array<Pair, bound_degree + 1> b;
#pragma GCC unroll 9
  for (std::size_t k = 0; k <= bound_degree; ++k) b[k] = share[k] * term_of(pair, first + k);
  Pair rest{};
#pragma GCC unroll 8
  for (std::size_t k = degree; k > first + bound_degree; --k) rest += absolute(term_of(pair, k));
  binomial_sums<bound_degree>(b.data());
  Range found{b[0], b[0]};
#pragma GCC unroll 8
  for (std::size_t j = 1; j <= bound_degree; ++j) {
    found.low = smaller(found.low, b[j]);
    found.high = larger(found.high, b[j]);
  }
  return {found.low - rest, found.high + rest};
}

}  // namespace

void series_start(const double* terms, std::size_t n, double* x) {
  for (std::size_t i = 0; i < n; ++i) x[i] = terms[series_place(i)];
}

void series_values(const double* terms, std::size_t n, double theta, double* __restrict x) {
  for (std::size_t i = 0; i < n; i += 2, terms += series_stride) {
    Pair sum = term_of(terms, degree);
    for (std::size_t k = degree; k-- > 0;) sum = term_of(terms, k) + theta * sum;
    store_pair(x, n, i, sum);
  }
}

void series_slopes(const double* terms, std::size_t n, double theta, double h, double* __restrict xdot) {
  for (std::size_t i = 0; i < n; i += 2, terms += series_stride) {
    Pair sum{};
    for (std::size_t k = degree; k > 0; --k) sum = static_cast<double>(k) * term_of(terms, k) + theta * sum;
    store_pair(xdot, n, i, sum / h);
  }
}

void series_bounds(const double* terms, std::size_t n, double* __restrict low, double* __restrict high) {
  for (std::size_t i = 0; i < n; i += 2, terms += series_stride) {
    const Range found = range<0>(terms);
    store_pair(low, n, i, found.low);
    store_pair(high, n, i, found.high);
  }
}

Series::Series(std::size_t n) : n_(n), scaled_(series_size(n)), terms_(series_size(n)), current_(n), next_(n) {}

/// unit^(k+1) v_(k+1) = unit / (k + 1) A unit^k v_k; from current_ into next_ and the terms.
void Series::multiply(const LinearField& field, std::size_t k) {
  const double scale = unit_ * inverse[k + 1];
  const double* diagonal = field.diagonal.data();
  const double* entries = field.entry.data();
  const std::size_t* columns = field.column.data();
  const double* __restrict current = current_.data();
  double* __restrict next = next_.data();
  std::size_t entry = 0;
  for (std::size_t i = 0; i < n_; ++i) {
    double sum = diagonal[i] * current[i];
    for (const std::size_t end = field.start[i + 1]; entry < end; ++entry)
      sum += entries[entry] * current[columns[entry]];
    next[i] = scale * sum;
  }
}

void Series::keep(std::size_t k) {
  double* scaled = scaled_.data() + 2 * k;
  for (std::size_t i = 0; i < n_; ++i) scaled[series_place(i)] = next_[i];
  current_.swap(next_);
}

void Series::begin(const LinearField& field, const double* x, const double* slope, double h) {
  unit_ = power_of_two_below(h);
  const bool diagonal = field.entry.empty();
  const double* rate = field.rate.empty() ? nullptr : field.rate.data();
  const double half_square = 0.5 * unit_ * unit_;
  double* scaled = scaled_.data();
  for (std::size_t i = 0; i < n_; i += 2, scaled += series_stride) {
    store(scaled, load_pair(x, n_, i));
    Pair term = unit_ * load_pair(slope, n_, i);
    store(scaled + 2, term);
    if (!diagonal) continue;
    const Pair factor = unit_ * load_pair(field.diagonal.data(), n_, i);
    term = factor * term * inverse[2];
    if (rate != nullptr) term += half_square * load_pair(rate, n_, i);
    store(scaled + 4, term);
#pragma GCC unroll 16
    for (std::size_t k = 3; k <= degree; ++k) {
      term = factor * inverse[k] * term;
      store(scaled + 2 * k, term);
    }
  }
  if (diagonal) return;
  switch ((n_ + 1) / 2) {
    case 1:
      return multiply_few<1>(field, scaled_.data(), unit_);
    case 2:
      return multiply_few<2>(field, scaled_.data(), unit_);
    case 3:
      return multiply_few<3>(field, scaled_.data(), unit_);
    default:
      break;
  }
  for (std::size_t i = 0; i < n_; ++i) current_[i] = unit_ * slope[i];
  for (std::size_t k = 1; k < degree; ++k) {
    multiply(field, k);
    for (std::size_t i = 0; k == 1 && rate != nullptr && i < n_; ++i) next_[i] += half_square * rate[i];
    keep(k + 1);
  }
}

void Series::take(double h, double* __restrict x_new) {
  std::array<Pair, degree + 1> power;
  power[0] = both(1.0);
  power[1] = both(h / unit_);
#pragma GCC unroll 16
  for (std::size_t k = 2; k <= degree; ++k) power[k] = power[k / 2] * power[k - k / 2];
  const double* scaled = scaled_.data();
  double* terms = terms_.data();
  for (std::size_t i = 0; i < n_; i += 2, scaled += series_stride, terms += series_stride) {
    Pair sum{};
#pragma GCC unroll 16
    for (std::size_t k = degree; k > 0; --k) {
      const Pair term = power[k] * term_of(scaled, k);
      store(terms + 2 * k, term);
      sum += term;
    }
    store(terms, term_of(scaled, 0));
    store_pair(x_new, n_, i, term_of(scaled, 0) + sum);
  }
}

/// The neglected terms are smaller than the last one; where that happens to vanish, than an eighth of the one before,
/// up to h |A| = 5.8: |A h|^2 / (17 * 16) = 1/8.
double Series::error_norm(const double* x_new, const Tolerances& tolerances) const {
  const double* terms = terms_.data();
  Pair largest{}, sum{};
  for (std::size_t i = 0; i < n_; i += 2, terms += series_stride) {
    const Pair scale = error_scale(tolerances, term_of(terms, 0), load_pair(x_new, n_, i));
    const Pair error = larger(absolute(term_of(terms, degree)), 0.125 * absolute(term_of(terms, degree - 1)));
    const Pair ratio = error / scale;
    largest = larger(largest, ratio);
    sum += ratio;
  }
  const double total = sum_of_lanes(sum);
  return std::isnan(total) ? total : largest_lane(largest);
}

/// (x(theta) - x) / (theta h) = (a_1 + a_2 theta + ...) / h.
void Series::mean_slopes(double h, double* __restrict low, double* __restrict high) const {
  const double* terms = terms_.data();
  for (std::size_t i = 0; i < n_; i += 2, terms += series_stride) {
    const Range found = range<1>(terms);
    const Pair one = found.low / h;
    const Pair other = found.high / h;
    store_pair(low, n_, i, smaller(one, other));
    store_pair(high, n_, i, larger(one, other));
  }
}

/// Of the last two terms one follows from the other by h A / degree.
double Series::stability_ratio(const Tolerances& tolerances) const {
  const double* terms = terms_.data();
  Pair after{}, before{}, size{};  // squares
  for (std::size_t i = 0; i < n_; i += 2, terms += series_stride) {
    const Pair x = term_of(terms, 0);
    const Pair unit = error_scale(tolerances, x, x);
    const Pair last = term_of(terms, degree) / unit, one_before = term_of(terms, degree - 1) / unit;
    after += last * last;
    before += one_before * one_before;
    size += (x / unit) * (x / unit);
  }
  constexpr double rounding = 64.0 * std::numeric_limits<double>::epsilon();
  const double divisor = sum_of_lanes(before);
  if (!(divisor > rounding * rounding * sum_of_lanes(size))) return 0.0;
  // Of 1 + z + ... + z^16 / 16! on the negative axis; 6.3 near the imaginary one.
  constexpr double stability_limit = 7.3;
  return static_cast<double>(degree) * std::sqrt(sum_of_lanes(after) / divisor) / stability_limit;
}

}  // namespace saltus::ode
