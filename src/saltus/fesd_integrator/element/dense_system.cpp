#include <algorithm>
#include <cmath>
#include <utility>

#include "saltus/base/at.hpp"
#include "saltus/fesd_integrator/element/dense_system_internal.hpp"

namespace saltus::fesd_integrator {

/// Matrix and right side as they are; false if something in them is not finite.
bool DenseSystem::keep_copy() {
  double sum = 0.0;  // finite if everything is, or if it overflows
  for (linalg::Index j = 0; j < n_; ++j) {
    const double* from = memory_.data() + j * n_;
    double* to = copy_.data() + j * n_;
    double largest = 0.0;
    for (linalg::Index i = 0; i < n_; ++i) {
      const double size = std::abs(from[i]);
      to[i] = from[i];
      largest = std::max(largest, size);
      sum += size;
    }
    column_sizes_(j) = largest;
  }
  for (linalg::Index i = 0; i < n_; ++i) {
    right_copy_(i) = right_(i);
    sum += std::abs(right_(i));
  }
  return std::isfinite(sum) || (copy_.head(n_ * n_).all_finite() && right_copy_.head(n_).all_finite());
}

bool DenseSystem::eliminate() {
  // A pivot at the rounding level of its column is that of a singular matrix; 1e-13 leaves three digits to rounding.
  constexpr double singular = 1e-13;
  for (linalg::Index k = 0; k < n_; ++k) {
    double* column = memory_.data() + k * n_;
    linalg::Index pivot = k;
    double largest = std::abs(column[k]);
    for (linalg::Index i = k + 1; i < n_; ++i) {
      if (std::abs(column[i]) > largest) {
        largest = std::abs(column[i]);
        pivot = i;
      }
    }
    if (!(largest > singular * column_sizes_(k))) return false;
    pivots_[at(k)] = pivot;
    if (pivot != k) {
      for (linalg::Index j = 0; j < n_; ++j) std::swap(memory_[j * n_ + k], memory_[j * n_ + pivot]);
    }
    const double inverse = 1.0 / column[k];
    for (linalg::Index i = k + 1; i < n_; ++i) column[i] *= inverse;
    for (linalg::Index j = k + 1; j < n_; ++j) {
      double* other = memory_.data() + j * n_;
      const double factor = other[k];
      if (factor == 0.0) continue;
      for (linalg::Index i = k + 1; i < n_; ++i) other[i] -= column[i] * factor;
    }
  }
  return true;
}

void DenseSystem::substitute() {
  double* b = right_.data();
  for (linalg::Index k = 0; k < n_; ++k) {
    const linalg::Index pivot = pivots_[at(k)];
    if (pivot != k) std::swap(b[k], b[pivot]);
  }
  for (linalg::Index k = 0; k < n_; ++k) {
    const double* column = memory_.data() + k * n_;
    const double factor = b[k];
    if (factor == 0.0) continue;
    for (linalg::Index i = k + 1; i < n_; ++i) b[i] -= column[i] * factor;
  }
  for (linalg::Index k = n_ - 1; k >= 0; --k) {
    const double* column = memory_.data() + k * n_;
    b[k] /= column[k];
    for (linalg::Index i = 0; i < k; ++i) b[i] -= column[i] * b[k];
  }
}

bool DenseSystem::solve_again() {
  substitute();
  return right().all_finite();
}

linalg::Matrix DenseSystem::null_space() const {
  if (n_ == 0 || factorised_) return linalg::Matrix(n_, 0);
  return orthogonal_.null_space();
}

bool DenseSystem::solve(double negligible, Unit unit) {
  if (n_ == 0) return true;
  if (!keep_copy()) return false;
  factorised_ = eliminate();
  if (factorised_) return solve_again();
  orthogonal_.set_threshold(1e-12);
  // Rows in units of their own, by powers of two: surfaces and states have nothing in common, and which rank a matrix
  // has is relative to its largest column.
  const linalg::ConstView original(copy_.data(), n_, n_);
  auto scaled = matrix();
  const auto power = [&](linalg::Index i) {
    const double largest = original.row(i).max_abs();
    return largest > 0.0 ? -std::ilogb(largest) : 0;
  };
  for (linalg::Index i = 0; i < n_; ++i) {
    const int own = power(i);
    for (linalg::Index j = 0; j < n_; ++j) scaled(i, j) = std::ldexp(original(i, j), own);
    right_(i) = std::ldexp(right_copy_(i), own);
  }
  orthogonal_.compute(scaled);
  right() = orthogonal_.solve(right());
  if (!right().all_finite()) return false;
  // Consistent but for the threshold.
  double wanted = 0.0, missed = 0.0;
  for (linalg::Index i = 0; i < n_; ++i) {
    const int own = unit == Unit::row ? power(i) : 0;
    wanted = std::max(wanted, std::abs(std::ldexp(right_copy_(i), own)));
    missed = std::max(missed, std::abs(std::ldexp(original.row(i).dot(right()) - right_copy_(i), own)));
  }
  return missed <= 1e-9 * wanted + negligible;
}

}  // namespace saltus::fesd_integrator
