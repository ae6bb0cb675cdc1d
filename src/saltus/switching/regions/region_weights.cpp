#include "saltus/switching/regions/region_weights.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numeric>
#include <utility>

#include "saltus/base/at.hpp"
#include "saltus/switching/table/matrix_stability.hpp"
#include "saltus/switching/table/newton_steps_internal.hpp"

namespace saltus::switching {
namespace {

// Vectors have at most as many entries as there are regions, inside of them: without allocation.
using linalg::Vector;

/// p^e for e = 0 or e >= 1, continued to p < 0: as a polynomial where it is one, else by 0.
double power(double p, double e) {
  if (e == 0.0) return 1.0;
  if (e == 1.0) return p;
  if (p <= 0.0 && e != std::round(e)) return 0.0;
  return std::pow(p, e);
}

double power_slope(double p, double e) { return e == 0.0 ? 0.0 : e == 1.0 ? 1.0 : e * power(p, e - 1.0); }

/// Facets that have a vertex in common, with independent_normals normals: as many as there are.
constexpr double independent_normals = 1e-6;

/// The part of a vector along each column of an orthonormal basis, one after the other.
void take_out(linalg::ConstView basis, Vector& rest) {
  for (linalg::Index l = 0; l < basis.cols(); ++l) rest.add_scaled(-basis.col(l).dot(rest), basis.col(l));
}

}  // namespace

RegionWeights::RegionWeights(RegionPolytope polytope) : polytope_(std::move(polytope)) {
  const auto m = static_cast<std::size_t>(polytope_.dimension());
  const auto facets = polytope_.facets().size();
  const auto half = m > 0 ? RegionBits{1} << (m - 1) : RegionBits{0};
  is_box_ = m > 0 && facets == 2 * m && static_cast<RegionBits>(polytope_.regions()) == 2 * half &&
            std::all_of(polytope_.facets().begin(), polytope_.facets().end(), [&](RegionBits facet) {
              return std::popcount(facet) == static_cast<int>(half) &&
                     std::any_of(polytope_.facets().begin(), polytope_.facets().end(),
                                 [&](RegionBits other) { return (facet & other) == 0; });
            });
  excess_.assign(polytope_.facets().size(), 0.0);
  order_.resize(std::max(excess_.size(), static_cast<std::size_t>(polytope_.regions())));
  chart_.reserve(m);
}

/// m facets through a vertex, those with the smallest excess first: the way out is through one of them.
void RegionWeights::choose_chart(const double* theta) {
  const auto& facets = polytope_.facets();
  const auto n = polytope_.regions();
  const auto m = static_cast<std::size_t>(polytope_.dimension());
  for (std::size_t f = 0; f < facets.size(); ++f) {
    excess_[f] = 0.0;
    for (int i = 0; i < n; ++i) {
      if ((facets[f] >> i & 1U) == 0) excess_[f] += theta[i];
    }
  }
  std::iota(order_.begin(), order_.begin() + index(facets.size()), std::size_t{0});
  // NOTE: std::stable_sort allocates.
  std::sort(order_.begin(), order_.begin() + index(facets.size()),
            [&](std::size_t a, std::size_t b) { return excess_[a] != excess_[b] ? excess_[a] < excess_[b] : a < b; });
  chart_.clear();
  RegionBits common = (RegionBits{1} << n) - 1;
  basis_.resize(index(m), index(m));  // orthonormal, of the normals so far
  for (std::size_t k = 0; k < facets.size() && chart_.size() < m; ++k) {
    const std::size_t f = order_[k];
    if ((common & facets[f]) == 0) continue;
    Vector normal = polytope_.normals().row(index(f));
    const double length = normal.norm();
    take_out(basis_.left_cols(index(chart_.size())), normal);
    if (!(normal.norm() > independent_normals * length)) continue;
    basis_.col(index(chart_.size())) = normal.normalized();
    common &= facets[f];
    chart_.push_back(f);
  }
  exponents_.resize(n, index(chart_.size()));
  for (std::size_t k = 0; k < chart_.size(); ++k) {
    exponents_.col(index(k)) = polytope_.heights().row(index(chart_[k]));
  }
}

/// p from the largest weights that determine it.
void RegionWeights::place_start(const double* theta) {
  const auto m = index(chart_.size());
  const auto n = static_cast<std::size_t>(polytope_.regions());
  std::iota(order_.begin(), order_.begin() + index(n), std::size_t{0});
  std::sort(order_.begin(), order_.begin() + index(n),
            [&](std::size_t a, std::size_t b) { return theta[a] != theta[b] ? theta[a] > theta[b] : a < b; });
  constexpr double least = 1e-300;
  const auto logarithm = [&](std::size_t i) { return std::log(std::max(theta[i], least)); };
  basis_.resize(m, m);
  matrix_.set_zero(m, m);
  p_.set_zero(m);
  linalg::Index rows = 0;
  const std::size_t first = order_[0];
  for (std::size_t k = 1; k < n && rows < m; ++k) {
    const std::size_t i = order_[k];
    const Vector row = exponents_.row(index(i)) - exponents_.row(index(first));
    Vector rest = row;
    take_out(basis_.left_cols(rows), rest);
    if (!(rest.norm() > independent_normals * row.norm())) continue;
    basis_.col(rows) = rest.normalized();
    matrix_.row(rows) = row;
    p_[rows++] = logarithm(i) - logarithm(first);
  }
  factors_.compute(matrix_);
  factors_.solve_in_place(p_);
  for (double& p : p_) p = std::exp(std::clamp(p, -700.0, 50.0));
}

/// Value, slopes and the derivative of sum_i M_i(p) r_i.
void RegionWeights::evaluate(const linalg::Matrix& rates) {
  const auto n = exponents_.rows();
  const auto m = exponents_.cols();
  monomials_.resize(n);
  slopes_.resize(n, m);
  for (linalg::Index i = 0; i < n; ++i) {
    double product = 1.0;
    for (linalg::Index k = 0; k < m; ++k) product *= power(p_[k], exponents_(i, k));
    monomials_[i] = product;
    for (linalg::Index l = 0; l < m; ++l) {
      double slope = power_slope(p_[l], exponents_(i, l));
      for (linalg::Index k = 0; k < m; ++k) {
        if (k != l) slope *= power(p_[k], exponents_(i, k));
      }
      slopes_(i, l) = slope;
    }
  }
  value_.resize(m);
  linalg::multiply(rates, monomials_, value_);
  jacobian_.resize(m, m);
  linalg::multiply(rates, slopes_, jacobian_);
}

bool RegionWeights::iterate(const linalg::Matrix& rates) {
  constexpr int iterations = 50;
  constexpr double astray = 1e6;
  NewtonSteps steps;
  for (int k = 0; k < iterations; ++k) {
    evaluate(rates);
    factors_.compute(jacobian_);
    step_ = value_;
    factors_.solve_in_place(step_);
    if (!step_.all_finite()) return false;
    p_ -= step_;
    const double size = step_.max_abs();
    const double reach = p_.max_abs();
    if (!(reach < astray)) return false;
    if (steps.end_with({size, reach})) return true;
  }
  return false;
}

void RegionWeights::finish(const linalg::Matrix& rates, double* theta) {
  evaluate(rates);
  const auto n = monomials_.size();
  const double sum = monomials_.sum();
  for (linalg::Index i = 0; i < n; ++i) theta[i] = monomials_[i] / sum;
  for (std::size_t f = 0; f < excess_.size(); ++f) {
    excess_[f] = 0.0;
    for (linalg::Index i = 0; i < n; ++i) {
      if ((polytope_.facets()[f] >> i & 1U) == 0) excess_[f] += theta[i];
    }
  }
  double size = 1.0;
  matrix_.resize(jacobian_.rows(), jacobian_.cols());  // of normals
  for (linalg::Index k = 0; k < jacobian_.rows(); ++k) {
    size *= jacobian_.row(k).norm();
    matrix_.row(k) = polytope_.normals().row(index(chart_[at(k)]));
  }
  factors_.compute(matrix_);
  const double orientation = factors_.determinant() > 0.0 ? 1.0 : -1.0;
  factors_.compute(jacobian_);
  determinant_ = size > 0.0 ? orientation * factors_.determinant() / size : 0.0;
}

bool RegionWeights::solve(const linalg::Matrix& rates, double* theta) {
  if (!rates.all_finite()) return false;
  if (polytope_.dimension() == 0) {
    std::fill_n(theta, polytope_.regions(), 1.0 / polytope_.regions());
    determinant_ = 1.0;
    return true;
  }
  choose_chart(theta);
  if (static_cast<int>(chart_.size()) < polytope_.dimension()) return false;
  place_start(theta);
  if (!p_.all_finite() || !iterate(rates)) return false;
  finish(rates, theta);
  return std::isfinite(determinant_) && monomials_.sum() > 0.0;
}

double RegionWeights::stability() const {
  const auto m = exponents_.cols();
  if (m < 2 || (m > 2 && !is_box_)) return 1.0;
  linalg::Matrix normals(m, m);
  for (linalg::Index k = 0; k < m; ++k) normals.row(k) = polytope_.normals().row(index(chart_[at(k)]));
  linalg::Matrix dynamics = normals * jacobian_;
  if (!is_box_) {
    // By nu . v. The determinant, which is 0 at exits, too, is that of the equations.
    dynamics.scale_cols(p_);
    return -dynamics.diagonal().sum() / dynamics.max_abs();
  }
  // By the selections, p / (1 + p) each.
  for (linalg::Index k = 0; k < m; ++k) dynamics.col(k) *= (1.0 + p_[k]) * (1.0 + p_[k]);
  std::array<double, 144> rows;
  for (linalg::Index k = 0; k < m * m; ++k) rows[at(k)] = dynamics(k / m, k % m);
  const std::span<const double> matrix(rows.data(), at(m * m));
  const auto n = static_cast<int>(m);
  const double margin = fisher_fuller_margin(matrix, n);
  return m == 2 ? margin : std::max(margin, hurwitz_margin(matrix, n));
}

linalg::Matrix weight_dynamics(linalg::ConstView points, linalg::ConstView rates, linalg::ConstView theta) {
  return rates * (linalg::scaled_rows(theta, points) - theta * (theta.transpose() * points));
}

}  // namespace saltus::switching
