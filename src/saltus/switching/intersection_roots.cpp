#include "saltus/switching/intersection_roots.hpp"

#include <algorithm>
#include <cmath>

#include "saltus/switching/plane_internal.hpp"
#include "saltus/switching/plane_symmetry_internal.hpp"

namespace saltus::switching {
namespace {

using Matrix = std::array<std::array<double, 2>, 2>;

double determinant(const Matrix& m) { return m[0][0] * m[1][1] - m[0][1] * m[1][0]; }

/// x2 s^2 + x1 s + x0.
struct Quadratic {
  double x2, x1, x0;

  /// The zero at which the derivative is `slope`, with |slope| the square root of the discriminant: the formula that
  /// adds numbers of one sign. Not finite where there is none.
  [[nodiscard]] double zero(double slope) const {
    return (x1 > 0.0) == (slope > 0.0) ? -2.0 * x0 / (x1 + slope) : (slope - x1) / (2.0 * x2);
  }
};

/// P for either selection, signed so that the derivative of both at a root is det G.
struct Eliminants {
  Bilinear g1, g2;
  Quadratic first, second;

  explicit Eliminants(const Plane& plane)
      : g1(plane.g(0)),
        g2(plane.g(1)),
        first{g1.b * g2.d - g2.b * g1.d, (g1.a * g2.d - g2.a * g1.d) + (g1.b * g2.c - g2.b * g1.c),
              g1.a * g2.c - g2.a * g1.c},
        second{g2.c * g1.d - g1.c * g2.d, (g2.a * g1.d - g1.a * g2.d) + (g1.b * g2.c - g2.b * g1.c),
               g2.a * g1.b - g1.a * g2.b} {}

  [[nodiscard]] double discriminant() const { return first.x1 * first.x1 - 4.0 * first.x2 * first.x0; }

  [[nodiscard]] Matrix jacobian(const PlaneAlpha& alpha) const {
    return {{{g1.b + g1.d * alpha[1], g1.c + g1.d * alpha[0]}, {g2.b + g2.d * alpha[1], g2.c + g2.d * alpha[0]}}};
  }

  /// The root with det G = slope, rows as in `plane`.
  [[nodiscard]] std::optional<SlidingRoot> root(double slope) const {
    SlidingRoot result;
    PlaneAlpha& alpha = result.alpha;
    alpha = {first.zero(slope), second.zero(slope)};
    if (!std::isfinite(alpha[0]) || !std::isfinite(alpha[1])) return std::nullopt;
    Matrix g = jacobian(alpha);
    // Newton removes the cancellation in the coefficients. Next to a double root it has nothing to hold on to.
    const double det = determinant(g);
    if (std::abs(det) > 1e-6) {
      const double r1 = g1(alpha);
      const double r2 = g2(alpha);
      alpha[0] -= (g[1][1] * r1 - g[0][1] * r2) / det;
      alpha[1] -= (g[0][0] * r2 - g[1][0] * r1) / det;
      g = jacobian(alpha);
    }
    result.sliding_jacobian = g;
    result.determinant = determinant(g);
    return result;
  }
};

/// From the rows of a Plane back to those of its table.
void scale_back(const Plane& plane, std::optional<SlidingRoot>& root) {
  if (!root) return;
  for (std::size_t j = 0; j < 2; ++j) {
    for (double& entry : root->sliding_jacobian[j]) entry = std::ldexp(entry, plane.exponent[j]);
  }
  root->determinant = determinant(root->sliding_jacobian);
}

}  // namespace

bool SlidingRoot::stabilisable() const {
  return determinant > 0.0 && std::min(sliding_jacobian[0][0], sliding_jacobian[1][1]) < 0.0;
}

bool SlidingRoot::stable(const std::array<double, 2>& surface_scaling) const {
  const double trace = surface_scaling[0] * sliding_jacobian[0][0] + surface_scaling[1] * sliding_jacobian[1][1];
  return determinant > 0.0 && trace < 0.0;
}

bool SlidingRoot::inside() const { return alpha[0] > 0.0 && alpha[0] < 1.0 && alpha[1] > 0.0 && alpha[1] < 1.0; }

IntersectionRoots intersection_roots(const Plane& plane) {
  const Eliminants eliminants(plane);
  IntersectionRoots roots;
  const double product = plane.scale[0] * plane.scale[1];
  const double discriminant = eliminants.discriminant();
  roots.discriminant = discriminant / (product * product);
  if (!(discriminant >= 0.0)) return roots;
  const double slope = std::sqrt(discriminant);
  roots.rising = eliminants.root(slope);
  roots.falling = eliminants.root(-slope);
  return roots;
}

IntersectionRoots intersection_roots(const PlaneTable& table) {
  const Plane plane(table);
  IntersectionRoots roots = intersection_roots(plane);
  scale_back(plane, roots.rising);
  scale_back(plane, roots.falling);
  return roots;
}

PlaneAlpha double_root(const Plane& plane) {
  const Eliminants eliminants(plane);
  return {-0.5 * eliminants.first.x1 / eliminants.first.x2, -0.5 * eliminants.second.x1 / eliminants.second.x2};
}

}  // namespace saltus::switching
