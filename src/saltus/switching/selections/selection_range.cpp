#include "saltus/switching/selections/selection_range.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <Eigen/Cholesky>

#include "saltus/base/at.hpp"
#include "saltus/switching/selections/column_flats.hpp"

namespace saltus::switching {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Below this, relative to what it is the sum of, d . B_i is 0: B comes from gradients and fields, good to 12 digits.
constexpr double no_part = 1e-10;

/// The direction normal to some columns, of length 1; false unless it is one.
bool normal_to(const MatrixXd& effects, const std::vector<Index>& columns, VectorXd& normal) {
  const Index r = effects.rows();
  if (r == 1) {
    normal = VectorXd::Ones(1);
    return true;
  }
  MatrixXd chosen(r, static_cast<Index>(columns.size()));
  for (Index k = 0; k < chosen.cols(); ++k) {
    const auto column = effects.col(columns[at(k)]);
    const double size = column.norm();
    if (size == 0.0) return false;
    chosen.col(k) = column / size;
  }
  const Eigen::ColPivHouseholderQR<MatrixXd> qr(chosen);
  // The last diagonal entry of R is the smallest one.
  if (!(std::abs(qr.matrixR()(r - 2, r - 2)) > 1e-9)) return false;
  normal = qr.householderQ() * VectorXd::Unit(r, r - 1);
  return true;
}

/// Both facets with a normal, whose first sign is positive; nullopt where all columns are normal to it.
/// @param scaled  rows of B in units of their sizes
std::optional<SelectionRange::Facets> facets_along(const MatrixXd& scaled, const VectorXd& sizes,
                                                   const VectorXd& normal) {
  SelectionRange::Facets facets;
  double sum = 0.0;
  for (Index i = 0; i < scaled.cols(); ++i) {
    const double part = normal.dot(scaled.col(i));
    const bool on = std::abs(part) <= no_part * scaled.col(i).norm();
    facets.sign.push_back(static_cast<std::int8_t>(on ? 0 : part > 0.0 ? 1 : -1));
    if (!on) sum += std::abs(part);
  }
  if (sum == 0.0) return std::nullopt;
  const auto first = std::find_if(facets.sign.begin(), facets.sign.end(), [](std::int8_t s) { return s != 0; });
  const double turn = *first < 0 ? -1.0 : 1.0;
  if (turn < 0.0) {
    for (auto& s : facets.sign) s = static_cast<std::int8_t>(-s);
  }
  facets.normal = turn / sum * sizes.cwiseInverse().cwiseProduct(normal);
  return facets;
}

double clip(double value) { return std::clamp(value, 0.0, 1.0); }

/// Antiderivative of clip(1/2 + s), 0 at s = 0.
double potential(double s) {
  if (s > 0.5) return 0.375 + (s - 0.5);
  return s < -0.5 ? -0.125 : 0.5 * s + 0.5 * s * s;
}

}  // namespace

bool SelectionRange::set(const MatrixXd& effects) {
  const bool same_size = effects.rows() == of_facets_.rows() && effects.cols() == of_facets_.cols();
  effects_ = effects;
  // Differences of fields vary by their rounding, relative to what a row is the sum of.
  if (same_size && ((effects - of_facets_).cwiseAbs().rowwise().maxCoeff().array() <=
                    1e-13 * of_facets_.cwiseAbs().rowwise().sum().array())
                       .all()) {
    return !facets_.empty();
  }
  of_facets_ = effects;
  facets_.clear();
  const Index r = effects.rows(), q = effects.cols();
  if (r == 0 || q < r || !effects.allFinite()) return false;
  // Rows in units of their own: velocities of different functions have nothing in common.
  const VectorXd sizes = effects.cwiseAbs().rowwise().sum();
  if (!(sizes.minCoeff() > 0.0)) return false;
  const MatrixXd scaled = sizes.cwiseInverse().asDiagonal() * effects;
  if (Eigen::ColPivHouseholderQR<MatrixXd>(scaled.transpose()).rank() < r) return false;
  const auto hyperplanes = column_hyperplanes(scaled, most_flats);
  if (!hyperplanes) return false;
  VectorXd normal;
  for (const auto& chosen : *hyperplanes) {
    if (!normal_to(scaled, chosen, normal)) continue;
    auto facets = facets_along(scaled, sizes, normal);
    if (!facets) continue;
    // Hyperplanes that differ by less than the rounding of their columns.
    const bool known =
        std::any_of(facets_.begin(), facets_.end(), [&](const Facets& other) { return other.sign == facets->sign; });
    if (!known) facets_.push_back(std::move(*facets));
  }
  return !facets_.empty();
}

SelectionRange::Span SelectionRange::span(std::size_t index, const VectorXd& constant) const {
  const Facets& facets = facets_[index];
  Span span;
  span.min = span.max = facets.normal.dot(constant);
  span.terms = facets.normal.cwiseAbs().dot(constant.cwiseAbs());
  for (Index i = 0; i < effects_.cols(); ++i) {
    const auto sign = facets.sign[at(i)];
    if (sign == 0) continue;
    const double part = facets.normal.dot(effects_.col(i));
    (sign > 0 ? span.max : span.min) += part;
    span.terms += facets.normal.cwiseAbs().dot(effects_.col(i).cwiseAbs());
  }
  return span;
}

VectorXd central_selections(const MatrixXd& effects, const VectorXd& constant) {
  return CentralSelections().solve(effects, constant);
}

const VectorXd& CentralSelections::solve(const MatrixXd& effects, const VectorXd& constant) {
  const bool same_size = effects.rows() == effects_.rows() && effects.cols() == effects_.cols();
  if (!same_size || effects != effects_) {
    effects_ = effects;
    factors_.compute(effects_);
    half_.setConstant(effects.cols(), 0.5);
  }
  excess_ = constant;
  excess_.noalias() += effects_ * half_;
  lambda_ = half_ - factors_.solve(excess_);
  return lambda_;
}

VectorXd bounded_selections(const MatrixXd& effects, const VectorXd& constant) {
  VectorXd lambda = central_selections(effects, constant);
  bound_selections(effects, constant, lambda);
  return lambda;
}

void bound_selections(const MatrixXd& effects, const VectorXd& constant, VectorXd& lambda) {
  const Index r = effects.rows(), q = effects.cols();
  if (lambda.minCoeff() >= 0.0 && lambda.maxCoeff() <= 1.0) return;
  VectorXd mu = VectorXd::Zero(r);
  const auto dual = [&](const VectorXd& at) {
    double value = constant.dot(at);
    for (Index i = 0; i < q; ++i) value += potential(effects.col(i).dot(at));
    return value;
  };
  const double size = constant.cwiseAbs().sum() + effects.cwiseAbs().sum();
  double value = 0.0;
  // NOTE: pieces are quadratic: Newton ends in finitely many steps where a solution is; the limit is for where none is.
  for (int iteration = 0; iteration < 60; ++iteration) {
    MatrixXd hessian = MatrixXd::Identity(r, r) * (1e-12 * effects.squaredNorm());
    for (Index i = 0; i < q; ++i) {
      const double s = 0.5 + effects.col(i).dot(mu);
      lambda[i] = clip(s);
      if (s > 0.0 && s < 1.0) hessian += effects.col(i) * effects.col(i).transpose();
    }
    const VectorXd residual = constant + effects * lambda;
    if (residual.cwiseAbs().maxCoeff() <= 1e-15 * size) break;
    const VectorXd step = -hessian.ldlt().solve(residual);
    double length = 1.0;
    const double slope = residual.dot(step);
    double next = dual(mu + step);
    while (next > value + 1e-4 * length * slope && length > 1e-12) {
      length *= 0.5;
      next = dual(mu + length * step);
    }
    mu += length * step;
    value = next;
  }
}

}  // namespace saltus::switching
