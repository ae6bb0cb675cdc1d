#include <cmath>
#include <utility>

#include "saltus/fesd_integrator/dense_system_internal.hpp"

namespace saltus::fesd_integrator {

bool DenseSystem::eliminate() {
  // A pivot at the rounding level of its column is that of a singular matrix; 1e-13 leaves three digits to rounding.
  constexpr double singular = 1e-13;
  auto a = matrix();
  auto b = right();
  for (Eigen::Index k = 0; k < n_; ++k) {
    Eigen::Index pivot = k;
    const double largest = a.col(k).tail(n_ - k).cwiseAbs().maxCoeff(&pivot);
    const double column = Eigen::Map<const Eigen::MatrixXd>(copy_.data(), n_, n_).col(k).cwiseAbs().maxCoeff();
    if (!(largest > singular * column)) return false;
    pivot += k;
    if (pivot != k) {
      a.row(k).swap(a.row(pivot));
      std::swap(b(k), b(pivot));
    }
    const double inverse = 1.0 / a(k, k);
    for (Eigen::Index i = k + 1; i < n_; ++i) a(i, k) *= inverse;
    for (Eigen::Index j = k + 1; j < n_; ++j) {
      const double factor = a(k, j);
      if (factor == 0.0) continue;
      for (Eigen::Index i = k + 1; i < n_; ++i) a(i, j) -= a(i, k) * factor;
    }
    for (Eigen::Index i = k + 1; i < n_; ++i) b(i) -= a(i, k) * b(k);
  }
  for (Eigen::Index k = n_ - 1; k >= 0; --k) {
    b(k) /= a(k, k);
    for (Eigen::Index i = 0; i < k; ++i) b(i) -= a(i, k) * b(k);
  }
  return true;
}

bool DenseSystem::solve(double negligible) {
  if (n_ == 0) return true;
  copy_.head(n_ * n_) = memory_.head(n_ * n_);
  right_copy_.head(n_) = right_.head(n_);
  if (!copy_.head(n_ * n_).allFinite() || !right_copy_.head(n_).allFinite()) return false;
  if (eliminate()) return right().allFinite();
  orthogonal_.setThreshold(1e-12);
  const Eigen::Map<const Eigen::MatrixXd> original(copy_.data(), n_, n_);
  orthogonal_.compute(original);
  right() = orthogonal_.solve(right_copy_.head(n_));
  if (!right().allFinite()) return false;
  // Consistent but for the threshold.
  const double wanted = right_copy_.head(n_).cwiseAbs().maxCoeff();
  const double missed = (original * right() - right_copy_.head(n_)).cwiseAbs().maxCoeff();
  return missed <= 1e-9 * wanted + negligible;
}

}  // namespace saltus::fesd_integrator
