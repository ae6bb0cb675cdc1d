// Factors of (shift - J) for sparse J of one pattern, with pivots on the diagonal.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstddef>
#include <vector>

#include "saltus/ode/sparse/elimination.hpp"

namespace saltus::ode {

/// Returns the largest part of a number: no square root as in its absolute value.
inline double largest_part(double value) { return std::abs(value); }
inline double largest_part(const std::complex<double>& value) {
  return std::max(std::abs(value.real()), std::abs(value.imag()));
}
inline double least_part(double value) { return largest_part(value); }
inline double least_part(const std::complex<double>& value) { return largest_part(value); }
inline double reciprocal(double value) { return 1.0 / value; }
inline std::complex<double> reciprocal(const std::complex<double>& value) {
  return std::conj(value) / std::norm(value);
}

/// Holds a real number and some complex ones, of as many systems with one pattern. Their chains of operations do not
/// wait for each other: all of them take hardly longer than one.
template <std::size_t pairs>
struct JointNumber {
  double real = 0.0;
  std::array<double, pairs> re{}, im{};

  JointNumber() = default;
  explicit JointNumber(double value) : real(value) { re.fill(value); }
  JointNumber& operator-=(double value) {
    real -= value;
    for (double& part : re) part -= value;
    return *this;
  }
  JointNumber& operator-=(const JointNumber& other) {
    real -= other.real;
    for (std::size_t k = 0; k < pairs; ++k) {
      re[k] -= other.re[k];
      im[k] -= other.im[k];
    }
    return *this;
  }
  friend JointNumber operator*(const JointNumber& a, const JointNumber& b) {
    JointNumber product;
    product.real = a.real * b.real;
    for (std::size_t k = 0; k < pairs; ++k) {
      product.re[k] = a.re[k] * b.re[k] - a.im[k] * b.im[k];
      product.im[k] = a.re[k] * b.im[k] + a.im[k] * b.re[k];
    }
    return product;
  }
};

template <std::size_t pairs>
double largest_part(const JointNumber<pairs>& value) {
  double largest = std::abs(value.real);
  for (std::size_t k = 0; k < pairs; ++k) {
    const double size = std::max(std::abs(value.re[k]), std::abs(value.im[k]));
    if (size > largest || std::isnan(size)) largest = size;  // NaN stays
  }
  return largest;
}
/// Returns the least one of the largest parts of its numbers.
template <std::size_t pairs>
double least_part(const JointNumber<pairs>& value) {
  double least = std::abs(value.real);
  for (std::size_t k = 0; k < pairs; ++k)
    least = std::min(least, std::max(std::abs(value.re[k]), std::abs(value.im[k])));
  return least;
}
template <std::size_t pairs>
JointNumber<pairs> reciprocal(const JointNumber<pairs>& value) {
  JointNumber<pairs> result;
  result.real = 1.0 / value.real;
  for (std::size_t k = 0; k < pairs; ++k) {
    const double norm = value.re[k] * value.re[k] + value.im[k] * value.im[k];
    result.re[k] = value.re[k] / norm;
    result.im[k] = -value.im[k] / norm;
  }
  return result;
}

/// Factorizes L U row by row: no search for pivots, and all places known beforehand. Cost: the products of entries; a
/// tenth of those with a search (tridiagonal).
template <class Number>
class DiagonalFactors {
 public:
  /// Uses the elimination, which stays where it is.
  void use(const Elimination& elimination) {
    elimination_ = &elimination;
    lower_.resize(elimination.lower.column.size());
    upper_.resize(elimination.upper.column.size());
    reciprocals_.resize(elimination.order.size());
    row_.assign(elimination.order.size(), Number(0.0));
  }

  /// Takes the entries of J in the order of the pattern. Returns false where a multiplier is beyond
  /// `largest_multiplier`, or the matrix is singular: the diagonal does not serve.
  [[nodiscard]] bool factorize(const std::vector<double>& entries, const Number& shift) {
    const auto& [order, places, slot, lower, upper] = *elimination_;
    for (std::size_t i = 0; i < order.size(); ++i) {
      for (std::size_t k = lower.start[i]; k < lower.start[i + 1]; ++k) row_[lower.column[k]] = Number(0.0);
      for (std::size_t k = upper.start[i]; k < upper.start[i + 1]; ++k) row_[upper.column[k]] = Number(0.0);
      row_[i] = shift;
      for (std::size_t k = places.start[i]; k < places.start[i + 1]; ++k) row_[places.column[k]] -= entries[slot[k]];
      for (std::size_t k = lower.start[i]; k < lower.start[i + 1]; ++k) {
        const std::size_t pivot = lower.column[k];
        const Number multiplier = row_[pivot] * reciprocals_[pivot];
        if (!(largest_part(multiplier) <= largest_multiplier)) return false;
        lower_[k] = multiplier;
        for (std::size_t j = upper.start[pivot]; j < upper.start[pivot + 1]; ++j) {
          row_[upper.column[j]] -= multiplier * upper_[j];
        }
      }
      for (std::size_t k = upper.start[i]; k < upper.start[i + 1]; ++k) upper_[k] = row_[upper.column[k]];
      reciprocals_[i] = reciprocal(row_[i]);
      if (!std::isfinite(largest_part(reciprocals_[i])) || least_part(reciprocals_[i]) == 0.0) return false;
    }
    return true;
  }

  /// Reads the right-hand sides by `right(i)`, and hands each solution to `take(i, number)`.
  template <class Right, class Take>
  void solve(Right right, Take take) {
    solve_part<Number>(
        right, take, [](const Number& number) -> const Number& { return number; },
        [](Number& number) -> Number& { return number; });
  }
  /// Does the same for the real ones of joint numbers.
  template <class Right, class Take>
  void solve_real(Right right, Take take) {
    solve_part<double>(
        right, take, [](const Number& number) { return number.real; },
        [](Number& number) -> double& { return number.real; });
  }

 private:
  template <class Part, class Right, class Take, class Read, class Place>
  void solve_part(Right right, Take take, Read read, Place place) {
    const auto& [order, entries, slot, lower, upper] = *elimination_;
    const std::size_t n = order.size();
    for (std::size_t i = 0; i < n; ++i) {
      Part sum = right(order[i]);
      for (std::size_t k = lower.start[i]; k < lower.start[i + 1]; ++k) {
        sum -= read(lower_[k]) * read(row_[lower.column[k]]);
      }
      place(row_[i]) = sum;
    }
    for (std::size_t i = n; i-- > 0;) {
      Part sum = read(row_[i]);
      for (std::size_t k = upper.start[i]; k < upper.start[i + 1]; ++k) {
        sum -= read(upper_[k]) * read(row_[upper.column[k]]);
      }
      place(row_[i]) = sum * read(reciprocals_[i]);
      take(order[i], read(row_[i]));
    }
  }

  static constexpr double largest_multiplier = 1e3;
  const Elimination* elimination_ = nullptr;
  std::vector<Number> lower_, upper_, reciprocals_;
  std::vector<Number> row_;  ///< work
};

}  // namespace saltus::ode
