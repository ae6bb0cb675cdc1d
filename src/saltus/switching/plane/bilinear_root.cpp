#include "saltus/switching/plane/bilinear_root.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace saltus::switching {
namespace {

using Pair = std::array<double, 2>;

double cross(const Pair& u, const Pair& v) { return u[0] * v[1] - u[1] * v[0]; }
Pair difference(const Pair& u, const Pair& v) { return {u[0] - v[0], u[1] - v[1]}; }

/// P(s) for one selection s: the values at 0 and 1, and the coefficient of s^2.
struct Quadratic {
  double at_zero, at_one, leading;
  [[nodiscard]] double slope_at_zero() const { return (at_one - at_zero) - leading; }
  [[nodiscard]] double slope_at_one() const { return (at_one - at_zero) + leading; }
};

/// `low` and `high`: g at s = 0 and 1, each with the other selection 0 and 1.
Quadratic resultant(const Pair& low_0, const Pair& low_1, const Pair& high_0, const Pair& high_1) {
  return {cross(low_0, low_1), cross(high_0, high_1), cross(difference(high_0, low_0), difference(high_1, low_1))};
}

/// Distance from s of the root with slope `root_slope`, given P(s), P'(s) and P''/2; of the vertex if that is 0.
double way_to_root(double value, double slope, double leading, double root_slope) {
  if (root_slope == 0.0 && leading != 0.0) return -slope / (2.0 * leading);
  if (std::signbit(slope) == std::signbit(root_slope)) return -2.0 * value / (root_slope + slope);
  return (root_slope - slope) / (2.0 * leading);
}

double size(const PairCorners& g, std::size_t j) {
  double square = 0.0;
  for (const auto& corner : g) square += corner[j] * corner[j];
  return std::sqrt(square);
}

}  // namespace

BilinearRoot bilinear_root(const PairCorners& g, RootKind kind) {
  BilinearRoot root;
  // The second one with its factors exchanged, so that it rises where det G > 0, too.
  const std::array<Quadratic, 2> quadratics{resultant(g[0], g[2], g[1], g[3]), resultant(g[1], g[0], g[3], g[2])};
  const double scale = size(g, 0) * size(g, 1);
  const Quadratic& first = quadratics[0];
  const double slope = first.slope_at_zero();
  const double discriminant = slope * slope - 4.0 * first.at_zero * first.leading;
  const double root_slope =
      std::copysign(discriminant > 0.0 ? std::sqrt(discriminant) : 0.0, kind == RootKind::rising ? 1.0 : -1.0);
  root.discriminant = discriminant / (scale * scale);
  for (std::size_t j = 0; j < 2; ++j) {
    const Quadratic& p = quadratics[j];
    const double below = p.slope_at_zero();
    const double above = p.slope_at_one();
    root.alpha[j] = way_to_root(p.at_zero, below, p.leading, root_slope);
    root.from_one[j] = way_to_root(p.at_one, above, p.leading, root_slope);
    root.condition[j] = 1.0 + scale / (std::abs(root_slope) + std::abs(root.alpha[j] < 0.5 ? below : above));
  }
  for (std::size_t j = 0; j < 2; ++j) {
    const double mixed = (g[3][j] - g[2][j]) - (g[1][j] - g[0][j]);
    root.G[j][0] = (g[1][j] - g[0][j]) + mixed * root.alpha[1];
    root.G[j][1] = (g[2][j] - g[0][j]) + mixed * root.alpha[0];
  }
  const double g11 = root.G[0][0] / size(g, 0);
  const double g22 = root.G[1][1] / size(g, 1);
  // The Fischer-Burmeister function: its zeros are the corner { min = 0 }, away from (0, 0) it is smooth.
  root.stability = std::hypot(g11, g22) - (g11 + g22);
  return root;
}

std::array<double, 2> balanced_selections(const PairCorners& g, const BilinearRoot& root) {
  // Four roundings of 1e-16 in either numerator, condition times as many in alpha: 1e-10 for a condition of 2.5e5.
  constexpr double well_conditioned = 2.5e5;
  if (!(std::max(root.condition[0], root.condition[1]) > well_conditioned && root.discriminant > 0.0))
    return root.alpha;
  const double sizes[] = {size(g, 0), size(g, 1)};
  const auto mixed = [&](std::size_t j) { return (g[3][j] - g[2][j]) - (g[1][j] - g[0][j]); };
  const auto length = [&](std::size_t j) { return std::hypot(root.G[j][0], root.G[j][1]) / sizes[j]; };
  const std::size_t j = length(1) > length(0) ? 1 : 0;
  auto [a, b] = root.alpha;
  // Errors are below 1/10 or no selections are left: 1e-2, 1e-4, ..., by Newton's method, to 1e-16.
  for (int iteration = 0; iteration < 4; ++iteration) {
    const double rest = (1.0 - b) * ((1.0 - a) * g[0][j] + a * g[1][j]) + b * ((1.0 - a) * g[2][j] + a * g[3][j]);
    const double by_a = (g[1][j] - g[0][j]) + mixed(j) * b;
    const double by_b = (g[2][j] - g[0][j]) + mixed(j) * a;
    const double factor = rest / (by_a * by_a + by_b * by_b);
    if (!std::isfinite(factor)) return root.alpha;
    a -= factor * by_a;
    b -= factor * by_b;
    if (!(std::abs(rest) > 4.0 * std::numeric_limits<double>::epsilon() * sizes[j])) break;
  }
  return {a, b};
}

}  // namespace saltus::switching
