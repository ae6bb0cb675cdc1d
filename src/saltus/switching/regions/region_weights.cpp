#include "saltus/switching/regions/region_weights.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numeric>
#include <utility>

#include <Eigen/LU>

#include "saltus/base/at.hpp"
#include "saltus/switching/table/matrix_stability.hpp"
#include "saltus/switching/table/newton_steps_internal.hpp"

namespace saltus::switching {
namespace {

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
  Small basis(index(m), index(m));  // orthonormal, of the normals so far
  for (std::size_t k = 0; k < facets.size() && chart_.size() < m; ++k) {
    const std::size_t f = order_[k];
    if ((common & facets[f]) == 0) continue;
    // NOTE: g++ 12 with -O3 takes one initialised by the row for uninitialised where its norm is taken.
    SmallVector normal = SmallVector::Zero(index(m));
    normal = polytope_.normals().row(index(f)).transpose();
    const double length = polytope_.normals().row(index(f)).norm();
    for (std::size_t l = 0; l < chart_.size(); ++l) normal -= basis.col(index(l)).dot(normal) * basis.col(index(l));
    if (!(normal.norm() > independent_normals * length)) continue;
    basis.col(index(chart_.size())) = normal.normalized();
    common &= facets[f];
    chart_.push_back(f);
  }
  exponents_.resize(n, index(chart_.size()));
  for (std::size_t k = 0; k < chart_.size(); ++k) {
    exponents_.col(index(k)) = polytope_.heights().row(index(chart_[k])).transpose();
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
  Small basis(m, m);
  Small matrix(m, m);
  SmallVector right(m);
  Eigen::Index rows = 0;
  const std::size_t first = order_[0];
  for (std::size_t k = 1; k < n && rows < m; ++k) {
    const std::size_t i = order_[k];
    SmallVector row = (exponents_.row(index(i)) - exponents_.row(index(first))).transpose();
    SmallVector rest = row;
    for (Eigen::Index l = 0; l < rows; ++l) rest -= basis.col(l).dot(rest) * basis.col(l);
    if (!(rest.norm() > independent_normals * row.norm())) continue;
    basis.col(rows) = rest.normalized();
    matrix.row(rows) = row.transpose();
    right[rows++] = logarithm(i) - logarithm(first);
  }
  p_ = matrix.partialPivLu().solve(right);
  for (double& p : p_) p = std::exp(std::clamp(p, -700.0, 50.0));
}

/// Value, slopes and the derivative of sum_i M_i(p) r_i.
void RegionWeights::evaluate(const Eigen::MatrixXd& rates) {
  const auto n = exponents_.rows();
  const auto m = exponents_.cols();
  monomials_.resize(n);
  slopes_.resize(n, m);
  for (Eigen::Index i = 0; i < n; ++i) {
    double product = 1.0;
    for (Eigen::Index k = 0; k < m; ++k) product *= power(p_[k], exponents_(i, k));
    monomials_[i] = product;
    for (Eigen::Index l = 0; l < m; ++l) {
      double slope = power_slope(p_[l], exponents_(i, l));
      for (Eigen::Index k = 0; k < m; ++k) {
        if (k != l) slope *= power(p_[k], exponents_(i, k));
      }
      slopes_(i, l) = slope;
    }
  }
  value_.noalias() = rates * monomials_;
  jacobian_.noalias() = rates * slopes_;
}

bool RegionWeights::iterate(const Eigen::MatrixXd& rates) {
  constexpr int iterations = 50;
  constexpr double astray = 1e6;
  NewtonSteps steps;
  for (int k = 0; k < iterations; ++k) {
    evaluate(rates);
    const Eigen::PartialPivLU<Small> factors(jacobian_);
    step_ = factors.solve(value_);
    if (!step_.allFinite()) return false;
    p_ -= step_;
    const double size = step_.cwiseAbs().maxCoeff();
    const double reach = p_.cwiseAbs().maxCoeff();
    if (!(reach < astray)) return false;
    if (steps.end_with({size, reach})) return true;
  }
  return false;
}

void RegionWeights::finish(const Eigen::MatrixXd& rates, double* theta) {
  evaluate(rates);
  const auto n = monomials_.size();
  const double sum = monomials_.sum();
  for (Eigen::Index i = 0; i < n; ++i) theta[i] = monomials_[i] / sum;
  for (std::size_t f = 0; f < excess_.size(); ++f) {
    excess_[f] = 0.0;
    for (Eigen::Index i = 0; i < n; ++i) {
      if ((polytope_.facets()[f] >> i & 1U) == 0) excess_[f] += theta[i];
    }
  }
  double size = 1.0;
  Small normals(jacobian_.rows(), jacobian_.cols());
  for (Eigen::Index k = 0; k < jacobian_.rows(); ++k) {
    size *= jacobian_.row(k).norm();
    normals.row(k) = polytope_.normals().row(index(chart_[static_cast<std::size_t>(k)]));
  }
  const double orientation = normals.determinant() > 0.0 ? 1.0 : -1.0;
  determinant_ = size > 0.0 ? orientation * jacobian_.determinant() / size : 0.0;
}

bool RegionWeights::solve(const Eigen::MatrixXd& rates, double* theta) {
  if (!rates.allFinite()) return false;
  if (polytope_.dimension() == 0) {
    std::fill_n(theta, polytope_.regions(), 1.0 / polytope_.regions());
    determinant_ = 1.0;
    return true;
  }
  choose_chart(theta);
  if (static_cast<int>(chart_.size()) < polytope_.dimension()) return false;
  place_start(theta);
  if (!p_.allFinite() || !iterate(rates)) return false;
  finish(rates, theta);
  return std::isfinite(determinant_) && monomials_.sum() > 0.0;
}

double RegionWeights::stability() const {
  const auto m = exponents_.cols();
  if (m < 2 || (m > 2 && !is_box_)) return 1.0;
  Small normals(m, m);
  for (Eigen::Index k = 0; k < m; ++k)
    normals.row(k) = polytope_.normals().row(index(chart_[static_cast<std::size_t>(k)]));
  Small dynamics = normals * jacobian_;
  if (!is_box_) {
    // By nu . v. The determinant, which is 0 at exits, too, is that of the equations.
    dynamics *= p_.asDiagonal();
    return -dynamics.trace() / dynamics.cwiseAbs().maxCoeff();
  }
  // By the selections, p / (1 + p) each.
  for (Eigen::Index k = 0; k < m; ++k) dynamics.col(k) *= (1.0 + p_[k]) * (1.0 + p_[k]);
  std::array<double, 144> rows;
  for (Eigen::Index k = 0; k < m * m; ++k) rows[static_cast<std::size_t>(k)] = dynamics(k / m, k % m);
  const std::span<const double> matrix(rows.data(), static_cast<std::size_t>(m * m));
  const auto n = static_cast<int>(m);
  const double margin = fisher_fuller_margin(matrix, n);
  return m == 2 ? margin : std::max(margin, hurwitz_margin(matrix, n));
}

Eigen::MatrixXd weight_dynamics(const Eigen::MatrixXd& points, const Eigen::MatrixXd& rates,
                                const Eigen::VectorXd& theta) {
  return rates * (theta.asDiagonal() * points - theta * (theta.transpose() * points));
}

}  // namespace saltus::switching
