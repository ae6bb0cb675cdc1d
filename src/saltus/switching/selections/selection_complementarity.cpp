#include "saltus/switching/selections/selection_complementarity.hpp"

#include <algorithm>
#include <cmath>

#include "saltus/linalg/spectra.hpp"

namespace saltus::switching {
namespace {

using linalg::Index;
using linalg::Matrix;
using linalg::Vector;

constexpr int most_iterations = 20000;

/// Sweeps of lambda_i := clip(lambda_i - y_i / W_ii); whether they came to rest.
bool sweep(const Matrix& effects, const Vector& constant, Vector& lambda) {
  if (!(effects.diagonal().max() < 0.0)) return false;
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    double change = 0.0;
    for (Index i = 0; i < lambda.size(); ++i) {
      const double y = constant[i] + effects.row(i).dot(lambda);
      const double next = std::clamp(lambda[i] - y / effects(i, i), 0.0, 1.0);
      change = std::max(change, std::abs(next - lambda[i]));
      lambda[i] = next;
    }
    if (change <= 1e-14) return true;
  }
  return false;
}

/// Extragradient steps, for monotone W whatever its diagonal.
void descend(const Matrix& effects, const Vector& constant, Vector& lambda) {
  const double size = effects.norm();
  if (size == 0.0) {
    for (Index i = 0; i < lambda.size(); ++i) lambda[i] = constant[i] > 0.0 ? 1.0 : constant[i] < 0.0 ? 0.0 : lambda[i];
    return;
  }
  const double step = 0.7 / size;
  const auto clipped = [](const Vector& values) { return values.at_least(0.0).at_most(1.0); };
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    const Vector ahead = clipped(lambda + step * (constant + effects * lambda));
    const Vector next = clipped(lambda + step * (constant + effects * ahead));
    const double change = (next - lambda).max_abs();
    lambda = next;
    if (change <= 1e-14) return;
  }
}

/// A positive diagonal D with D W symmetric; false if there is none.
bool symmetrise(const Matrix& effects, Vector& scale) {
  const Index m = effects.rows();
  scale.set_zero(m);
  const double tiny = 1e-9 * effects.max_abs();
  for (Index start = 0; start < m; ++start) {
    if (scale[start] != 0.0) continue;
    scale[start] = 1.0;
    std::vector<Index> open{start};
    while (!open.empty()) {
      const Index i = open.back();
      open.pop_back();
      for (Index j = 0; j < m; ++j) {
        if (i == j || std::abs(effects(i, j)) <= tiny || scale[j] != 0.0) continue;
        if (!(effects(i, j) * effects(j, i) > 0.0)) return false;
        scale[j] = scale[i] * effects(i, j) / effects(j, i);
        open.push_back(j);
      }
    }
  }
  const Matrix scaled = linalg::scaled_rows(scale, effects);
  return (scaled - scaled.transpose()).max_abs() <= 1e-9 * scaled.max_abs();
}

/// Two solutions differ by d with d^T D W d >= 0; where D W is symmetric and <= 0 that is W d = 0. Functions whose own
/// selections move nothing follow from the others.
bool velocity_is_unique(const Matrix& all) {
  std::vector<Index> acting;
  for (Index i = 0; i < all.cols(); ++i) {
    if (all.col(i).max_abs() > 0.0) acting.push_back(i);
  }
  if (acting.empty()) return true;
  const Matrix effects = all.selected(acting, acting);
  Vector scale;
  if (!symmetrise(effects, scale)) return false;
  const Matrix scaled = linalg::scaled_rows(scale, effects);
  return linalg::symmetric_eigenvalues(0.5 * (scaled + scaled.transpose())).max() <= 1e-9 * scaled.norm();
}

}  // namespace

Complementarity solve_complementarity(const Matrix& effects, const Vector& constant, double tolerance) {
  Complementarity found;
  found.lambda = Vector::constant(constant.size(), 0.5);
  // Each surface in units of its own.
  const Vector sizes = (constant.abs() + effects.abs().row_sums()).at_least(1e-300).inverses();
  const Matrix scaled = linalg::scaled_rows(sizes, effects);
  const Vector offset = sizes.times_each(constant);
  if (!sweep(scaled, offset, found.lambda)) descend(scaled, offset, found.lambda);
  const Vector y = constant + effects * found.lambda;
  for (Index i = 0; i < y.size(); ++i) {
    const double terms = std::abs(constant[i]) + effects.row(i).sum_abs();
    const bool moves = std::abs(y[i]) > tolerance * terms;
    found.mode.push_back(!moves ? 0 : y[i] > 0.0 ? 1 : -1);
  }
  found.unique_velocity = velocity_is_unique(effects);
  return found;
}

}  // namespace saltus::switching
