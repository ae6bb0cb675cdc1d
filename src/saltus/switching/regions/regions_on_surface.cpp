#include "saltus/switching/regions/regions_on_surface.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "saltus/base/at.hpp"
#include "saltus/linalg/matrix.hpp"
#include "saltus/linalg/spectra.hpp"
#include "saltus/switching/table/matrix_stability.hpp"

namespace saltus::switching {
namespace {

using linalg::Index;
using linalg::Matrix;
using linalg::Vector;

double largest(const std::vector<double>& values) {
  double size = 0.0;
  for (const double value : values) size = std::max(size, std::abs(value));
  return size;
}

/// The equations of a set at alpha = 0 and 1: rows of its regions over the size of the rates, and that of psi over its.
struct Pencil {
  Matrix below, above;
};

struct Sizes {
  double rates = 1.0, velocity = 1.0;
};

Sizes sizes_of(const RegionsOnSurface& point) {
  const double rates = std::max(largest(point.below.rates), largest(point.above.rates));
  const double velocity = std::max(largest(point.velocity_below), largest(point.velocity_above));
  return {rates > 0.0 ? rates : 1.0, velocity > 0.0 ? velocity : 1.0};
}

Matrix equations(const RegionRates& rates, const std::vector<double>& velocity, const std::vector<int>& active,
                 const Sizes& sizes) {
  const auto k = static_cast<Index>(active.size());
  Matrix matrix = Matrix::zero(k + 1, k + 1);
  for (Index column = 0; column < k; ++column) {
    const auto j = at(active[at(column)]);
    for (Index row = 0; row < k; ++row) matrix(row, column) = rates.rate(at(active[at(row)]), j) / sizes.rates;
    matrix(k, column) = velocity[j] / sizes.velocity;
  }
  matrix.block(0, k, k, 1).set_constant(-1.0);
  return matrix;
}

/// theta and mu at an eigenvalue; false if they are not determined or do not sum to 1.
bool weights_at(const Pencil& pencil, double alpha, Vector& weights) {
  const Matrix matrix = (1.0 - alpha) * pencil.below + alpha * pencil.above;
  const auto [sizes, right] = linalg::singular_values(matrix);
  const auto last = matrix.cols() - 1;
  constexpr double several = 1e-9;
  if (last > 0 && !(sizes[last - 1] > several * sizes[0])) return false;
  weights = right.col(last);
  const double sum = weights.head(last).sum();
  if (!(std::abs(sum) > several)) return false;
  weights /= sum;
  return weights.all_finite();
}

double margin_of_slide(const RegionsOnSurface& point, const Sizes& sizes, const Vector& weights,
                       const RegionSlide& slide) {
  const auto& active = slide.regions.active;
  double margin = std::min(slide.alpha, 1.0 - slide.alpha);
  if (active.size() > 1) margin = std::min(margin, weights.head(weights.size() - 1).min());
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
  const linalg::ConstView theta(slide.regions.weights.data(), k);
  const Matrix mixed = (1.0 - slide.alpha) * pencil.below + slide.alpha * pencil.above;
  // Rates of psi_i = g_r - g_i for all but the first, and of psi.
  const auto rates_of = [&](const Matrix& matrix) {
    Matrix rates(k, k);
    for (Index i = 1; i < k; ++i) rates.row(i - 1) = matrix.row(0).head(k) - matrix.row(i).head(k);
    rates.row(k - 1) = matrix.row(k).head(k);
    return rates;
  };
  const Matrix spread = Matrix::diagonal_of(theta) - theta * theta.transpose();
  Matrix dynamics(k, k);
  dynamics.left_cols(k - 1) = rates_of(mixed) * spread.right_cols(k - 1);
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
  if (!pencil.below.all_finite() || !pencil.above.all_finite()) return found;
  const auto values = linalg::pencil_eigenvalues(pencil.below, pencil.below - pencil.above);
  if (!values) return found;
  for (const auto& [numerator, denominator] : *values) {
    // Infinite ones, or pairs of complex ones.
    if (!(std::abs(denominator) > 1e-14 * std::abs(numerator)) ||
        std::abs(numerator.imag()) > 1e-10 * std::abs(denominator)) {
      continue;
    }
    RegionSlide slide;
    slide.alpha = numerator.real() / denominator;
    Vector weights;
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
