#include "saltus/switching/selections/selection_range.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "saltus/base/at.hpp"
#include "saltus/linalg/factors.hpp"
#include "saltus/switching/selections/column_flats.hpp"

namespace saltus::switching {
namespace {

using linalg::Index;
using linalg::Matrix;
using linalg::Vector;

/// Below this, relative to what it is the sum of, d . B_i is 0: B comes from gradients and fields, good to 12 digits.
constexpr double no_part = 1e-10;

/// The direction normal to some columns, of length 1; false unless it is one.
bool normal_to(const Matrix& effects, const std::vector<Index>& columns, Vector& normal) {
  const Index r = effects.rows();
  if (r == 1) {
    normal = Vector::ones(1);
    return true;
  }
  Matrix chosen(r, static_cast<Index>(columns.size()));
  for (Index k = 0; k < chosen.cols(); ++k) {
    const auto column = effects.col(columns[at(k)]);
    const double size = column.norm();
    if (size == 0.0) return false;
    chosen.col(k) = column / size;
  }
  linalg::PivotedQr qr;
  qr.set_threshold(1e-9);  // of the first pivot, which is 1
  qr.compute(chosen);
  if (qr.rank() < r - 1) return false;
  normal = qr.times_q(Vector::unit(r, r - 1));
  return true;
}

/// Both facets with a normal, whose first sign is positive; nullopt where all columns are normal to it.
/// @param scaled  rows of B in units of their sizes
std::optional<SelectionRange::Facets> facets_along(const Matrix& scaled, const Vector& sizes, const Vector& normal) {
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
  facets.normal = normal.over_each(sizes);
  facets.normal *= turn / sum;
  return facets;
}

/// But for rounding: differences of fields vary by theirs, relative to what a row is the sum of.
bool are_equal(const Matrix& a, const Matrix& b) {
  for (Index i = 0; i < a.rows(); ++i) {
    if (!((a.row(i) - b.row(i)).max_abs() <= 1e-13 * b.row(i).sum_abs())) return false;
  }
  return true;
}

double clip(double value) { return std::clamp(value, 0.0, 1.0); }

/// Antiderivative of clip(1/2 + s), 0 at s = 0.
double potential(double s) {
  if (s > 0.5) return 0.375 + (s - 0.5);
  return s < -0.5 ? -0.125 : 0.5 * s + 0.5 * s * s;
}

}  // namespace

bool SelectionRange::set(const Matrix& effects) {
  const bool same_size = effects.rows() == of_facets_.rows() && effects.cols() == of_facets_.cols();
  effects_ = effects;
  if (same_size && are_equal(effects, of_facets_)) return !facets_.empty();
  of_facets_ = effects;
  facets_.clear();
  const Index r = effects.rows(), q = effects.cols();
  if (r == 0 || q < r || !effects.all_finite()) return false;
  // Rows in units of their own: velocities of different functions have nothing in common.
  const Vector sizes = effects.abs().row_sums();
  if (!(sizes.min() > 0.0)) return false;
  const Matrix scaled = linalg::scaled_rows(sizes.inverses(), effects);
  if (linalg::PivotedQr(scaled.transpose()).rank() < r) return false;
  const auto hyperplanes = column_hyperplanes(scaled, most_flats);
  if (!hyperplanes) return false;
  Vector normal;
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

SelectionRange::Span SelectionRange::span(std::size_t index, const Vector& constant) const {
  const Facets& facets = facets_[index];
  Span span;
  span.min = span.max = facets.normal.dot(constant);
  span.terms = facets.normal.abs().dot(constant.abs());
  for (Index i = 0; i < effects_.cols(); ++i) {
    const auto sign = facets.sign[at(i)];
    if (sign == 0) continue;
    const double part = facets.normal.dot(effects_.col(i));
    (sign > 0 ? span.max : span.min) += part;
    span.terms += facets.normal.abs().dot(effects_.col(i).abs());
  }
  return span;
}

Vector central_selections(const Matrix& effects, const Vector& constant) {
  return CentralSelections().solve(effects, constant);
}

const Vector& CentralSelections::solve(const Matrix& effects, const Vector& constant) {
  const bool same_size = effects.rows() == effects_.rows() && effects.cols() == effects_.cols();
  if (!same_size || !(effects == effects_)) {
    effects_ = effects;
    factors_.compute(effects_);
    half_.set_constant(effects.cols(), 0.5);
  }
  excess_ = constant;
  excess_ += effects_ * half_;
  lambda_ = half_;
  lambda_ -= factors_.solve(excess_);
  return lambda_;
}

Vector bounded_selections(const Matrix& effects, const Vector& constant) {
  Vector lambda = central_selections(effects, constant);
  bound_selections(effects, constant, lambda);
  return lambda;
}

void bound_selections(const Matrix& effects, const Vector& constant, Vector& lambda) {
  const Index r = effects.rows(), q = effects.cols();
  if (lambda.min() >= 0.0 && lambda.max() <= 1.0) return;
  Vector mu = Vector::zero(r);
  const auto dual = [&](const Vector& at) {
    double value = constant.dot(at);
    for (Index i = 0; i < q; ++i) value += potential(effects.col(i).dot(at));
    return value;
  };
  const double size = constant.sum_abs() + effects.sum_abs();
  double value = 0.0;
  // NOTE: pieces are quadratic: Newton ends in finitely many steps where a solution is; the limit is for where none is.
  for (int iteration = 0; iteration < 60; ++iteration) {
    Matrix hessian = Matrix::identity(r, r) * (1e-12 * effects.squared_norm());
    for (Index i = 0; i < q; ++i) {
      const double s = 0.5 + effects.col(i).dot(mu);
      lambda[i] = clip(s);
      if (s > 0.0 && s < 1.0) hessian += effects.col(i) * effects.col(i).transpose();
    }
    const Vector residual = constant + effects * lambda;
    if (residual.max_abs() <= 1e-15 * size) break;
    const Vector step = -linalg::Ldl(hessian).solve(residual);
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
