#include "saltus/switching/selections/selection_complementarity.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

namespace saltus::switching {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int most_iterations = 20000;

/// Sweeps of lambda_i := clip(lambda_i - y_i / W_ii); whether they came to rest.
bool sweep(const MatrixXd& effects, const VectorXd& constant, VectorXd& lambda) {
  if (!(effects.diagonal().maxCoeff() < 0.0)) return false;
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
void descend(const MatrixXd& effects, const VectorXd& constant, VectorXd& lambda) {
  const double size = effects.norm();
  if (size == 0.0) {
    for (Index i = 0; i < lambda.size(); ++i) lambda[i] = constant[i] > 0.0 ? 1.0 : constant[i] < 0.0 ? 0.0 : lambda[i];
    return;
  }
  const double step = 0.7 / size;
  const auto clipped = [](const VectorXd& values) { return values.cwiseMax(0.0).cwiseMin(1.0).eval(); };
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    const VectorXd ahead = clipped(lambda + step * (constant + effects * lambda));
    const VectorXd next = clipped(lambda + step * (constant + effects * ahead));
    const double change = (next - lambda).cwiseAbs().maxCoeff();
    lambda = next;
    if (change <= 1e-14) return;
  }
}

/// A positive diagonal D with D W symmetric; false if there is none.
bool symmetrise(const MatrixXd& effects, VectorXd& scale) {
  const Index m = effects.rows();
  scale.setZero(m);
  const double tiny = 1e-9 * effects.cwiseAbs().maxCoeff();
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
  const MatrixXd scaled = scale.asDiagonal() * effects;
  return (scaled - scaled.transpose()).cwiseAbs().maxCoeff() <= 1e-9 * scaled.cwiseAbs().maxCoeff();
}

/// Two solutions differ by d with d^T D W d >= 0; where D W is symmetric and <= 0 that is W d = 0. Functions whose own
/// selections move nothing follow from the others.
bool velocity_is_unique(const MatrixXd& all) {
  std::vector<Index> acting;
  for (Index i = 0; i < all.cols(); ++i) {
    if (all.col(i).cwiseAbs().maxCoeff() > 0.0) acting.push_back(i);
  }
  if (acting.empty()) return true;
  const MatrixXd effects = all(acting, acting);
  VectorXd scale;
  if (!symmetrise(effects, scale)) return false;
  const MatrixXd scaled = scale.asDiagonal() * effects;
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(0.5 * (scaled + scaled.transpose()), Eigen::EigenvaluesOnly);
  return eigen.eigenvalues().maxCoeff() <= 1e-9 * scaled.norm();
}

}  // namespace

Complementarity solve_complementarity(const MatrixXd& effects, const VectorXd& constant, double tolerance) {
  Complementarity found;
  found.lambda = VectorXd::Constant(constant.size(), 0.5);
  // Each surface in units of its own.
  const VectorXd sizes = (constant.cwiseAbs() + effects.cwiseAbs().rowwise().sum()).cwiseMax(1e-300).cwiseInverse();
  const MatrixXd scaled = sizes.asDiagonal() * effects;
  const VectorXd offset = sizes.cwiseProduct(constant);
  if (!sweep(scaled, offset, found.lambda)) descend(scaled, offset, found.lambda);
  const VectorXd y = constant + effects * found.lambda;
  for (Index i = 0; i < y.size(); ++i) {
    const double terms = std::abs(constant[i]) + effects.row(i).cwiseAbs().sum();
    const bool moves = std::abs(y[i]) > tolerance * terms;
    found.mode.push_back(!moves ? 0 : y[i] > 0.0 ? 1 : -1);
  }
  found.unique_velocity = velocity_is_unique(effects);
  return found;
}

}  // namespace saltus::switching
