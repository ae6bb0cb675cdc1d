#include "saltus/switching/regions/regions_on_surface.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>

#include "saltus/base/at.hpp"
#include "saltus/switching/table/matrix_stability.hpp"

namespace saltus::switching {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

double largest(const std::vector<double>& values) {
  double size = 0.0;
  for (const double value : values) size = std::max(size, std::abs(value));
  return size;
}

/// The equations of a set at alpha = 0 and 1: rows of its regions over the size of the rates, and that of psi over its.
struct Pencil {
  MatrixXd below, above;
};

struct Sizes {
  double rates = 1.0, velocity = 1.0;
};

Sizes sizes_of(const RegionsOnSurface& point) {
  const double rates = std::max(largest(point.below.rates), largest(point.above.rates));
  const double velocity = std::max(largest(point.velocity_below), largest(point.velocity_above));
  return {rates > 0.0 ? rates : 1.0, velocity > 0.0 ? velocity : 1.0};
}

MatrixXd equations(const RegionRates& rates, const std::vector<double>& velocity, const std::vector<int>& active,
                   const Sizes& sizes) {
  const auto k = static_cast<Index>(active.size());
  MatrixXd matrix = MatrixXd::Zero(k + 1, k + 1);
  for (Index column = 0; column < k; ++column) {
    const auto j = at(active[at(column)]);
    for (Index row = 0; row < k; ++row) matrix(row, column) = rates.rate(at(active[at(row)]), j) / sizes.rates;
    matrix(k, column) = velocity[j] / sizes.velocity;
  }
  matrix.block(0, k, k, 1).setConstant(-1.0);
  return matrix;
}

/// theta and mu at an eigenvalue; false if they are not determined or do not sum to 1.
bool weights_at(const Pencil& pencil, double alpha, VectorXd& weights) {
  const MatrixXd matrix = (1.0 - alpha) * pencil.below + alpha * pencil.above;
  const Eigen::JacobiSVD<MatrixXd> svd(matrix, Eigen::ComputeFullV);
  const auto last = matrix.cols() - 1;
  constexpr double several = 1e-9;
  if (last > 0 && !(svd.singularValues()[last - 1] > several * svd.singularValues()[0])) return false;
  weights = svd.matrixV().col(last);
  const double sum = weights.head(last).sum();
  if (!(std::abs(sum) > several)) return false;
  weights /= sum;
  return weights.allFinite();
}

double margin_of_slide(const RegionsOnSurface& point, const Sizes& sizes, const VectorXd& weights,
                       const RegionSlide& slide) {
  const auto& active = slide.regions.active;
  double margin = std::min(slide.alpha, 1.0 - slide.alpha);
  if (active.size() > 1) margin = std::min(margin, weights.head(weights.size() - 1).minCoeff());
  const double mu = weights[weights.size() - 1];
  for (int i = 0; i < point.below.regions; ++i) {
    if (std::binary_search(active.begin(), active.end(), i)) continue;
    double w = 0.0;
    for (std::size_t k = 0; k < active.size(); ++k) {
      const double below = point.below.rate(at(i), at(active[k])), above = point.above.rate(at(i), at(active[k]));
      w += (below + slide.alpha * (above - below)) * slide.regions.weights[k];
    }
    margin = std::min(margin, w / sizes.rates - mu);
  }
  return margin;
}

/// d (psi_i', psi') / d (u, w) with theta_i ~ exp(u_i), alpha = 1 / (1 + exp(-w)), over the sizes.
bool slide_attracts(const Pencil& pencil, const RegionSlide& slide) {
  const auto k = static_cast<Index>(slide.regions.active.size());
  const Eigen::Map<const VectorXd> theta(slide.regions.weights.data(), k);
  const MatrixXd mixed = (1.0 - slide.alpha) * pencil.below + slide.alpha * pencil.above;
  // Rates of psi_i = g_r - g_i for all but the first, and of psi.
  const auto rates_of = [&](const MatrixXd& matrix) {
    MatrixXd rates(k, k);
    for (Index i = 1; i < k; ++i) rates.row(i - 1) = matrix.row(0).head(k) - matrix.row(i).head(k);
    rates.row(k - 1) = matrix.row(k).head(k);
    return rates;
  };
  const MatrixXd spread = MatrixXd(theta.asDiagonal()) - theta * theta.transpose();
  MatrixXd dynamics(k, k);
  dynamics.leftCols(k - 1) = rates_of(mixed) * spread.rightCols(k - 1);
  dynamics.col(k - 1) = slide.alpha * (1.0 - slide.alpha) * (rates_of(pencil.above) - rates_of(pencil.below)) * theta;
  std::vector<double> entries;
  for (Index row = 0; row < k; ++row) {
    for (Index column = 0; column < k; ++column) entries.push_back(dynamics(row, column));
  }
  return is_hurwitz(entries, static_cast<int>(k));
}

std::vector<RegionSlide> slides_of(const RegionsOnSurface& point, const std::vector<int>& active) {
  const Sizes sizes = sizes_of(point);
  const Pencil pencil{equations(point.below, point.velocity_below, active, sizes),
                      equations(point.above, point.velocity_above, active, sizes)};
  std::vector<RegionSlide> found;
  if (!pencil.below.allFinite() || !pencil.above.allFinite()) return found;
  const Eigen::GeneralizedEigenSolver<MatrixXd> eigen(pencil.below, pencil.below - pencil.above, false);
  if (eigen.info() != Eigen::Success) return found;
  for (Index i = 0; i < eigen.alphas().size(); ++i) {
    const auto numerator = eigen.alphas()[i];
    const double denominator = eigen.betas()[i];
    // Infinite ones, or pairs of complex ones.
    if (!(std::abs(denominator) > 1e-14 * std::abs(numerator)) ||
        std::abs(numerator.imag()) > 1e-10 * std::abs(denominator)) {
      continue;
    }
    RegionSlide slide;
    slide.alpha = numerator.real() / denominator;
    VectorXd weights;
    if (!weights_at(pencil, slide.alpha, weights)) continue;
    slide.regions.active = active;
    slide.regions.weights.assign(weights.data(), weights.data() + active.size());
    slide.regions.margin = margin_of_slide(point, sizes, weights, slide);
    slide.regions.attracts = slide_attracts(pencil, slide);
    found.push_back(std::move(slide));
  }
  return found;
}

}  // namespace

std::vector<RegionSlide> admissible_region_slides(const RegionsOnSurface& point, double tolerance) {
  std::vector<RegionSlide> found;
  std::vector<int> active;
  for (unsigned subset = 1; subset < 1U << point.below.regions; ++subset) {
    active.clear();
    for (int i = 0; i < point.below.regions; ++i) {
      if ((subset >> i & 1U) != 0) active.push_back(i);
    }
    for (auto& slide : slides_of(point, active)) {
      if (slide.regions.margin >= -tolerance) found.push_back(std::move(slide));
    }
  }
  return found;
}

bool solve_region_slide(const RegionsOnSurface& point, const std::vector<int>& active, double near,
                        RegionSlide& slide) {
  auto slides = slides_of(point, active);
  const auto nearest = std::min_element(slides.begin(), slides.end(), [&](const auto& a, const auto& b) {
    return std::abs(a.alpha - near) < std::abs(b.alpha - near);
  });
  if (nearest == slides.end()) return false;
  slide = std::move(*nearest);
  return true;
}

}  // namespace saltus::switching
