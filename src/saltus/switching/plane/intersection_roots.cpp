#include "saltus/switching/plane/intersection_roots.hpp"

#include <algorithm>
#include <cmath>

#include "saltus/switching/plane/bilinear_root.hpp"
#include "saltus/switching/plane/plane_internal.hpp"
#include "saltus/switching/plane/plane_symmetry_internal.hpp"

namespace saltus::switching {
namespace {

using SquareOfTwo = std::array<std::array<double, 2>, 2>;

double determinant(const SquareOfTwo& m) { return m[0][0] * m[1][1] - m[0][1] * m[1][0]; }

PairCorners corners_of(const Plane& plane) {
  PairCorners g;
  for (std::size_t k = 0; k < 4; ++k) g[k] = {plane.f[0][k], plane.f[1][k]};
  return g;
}

std::optional<SlidingRoot> finite(const BilinearRoot& root) {
  if (!std::isfinite(root.alpha[0]) || !std::isfinite(root.alpha[1])) return std::nullopt;
  return SlidingRoot{root.alpha, root.G, determinant(root.G)};
}

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

bool SlidingRoot::inside() const { return alpha[0] > 0.0 && alpha[0] < 1.0 && alpha[1] > 0.0 && alpha[1] < 1.0; }

IntersectionRoots intersection_roots(const Plane& plane) {
  const PairCorners g = corners_of(plane);
  const BilinearRoot rising = bilinear_root(g, RootKind::rising);
  IntersectionRoots roots;
  roots.discriminant = rising.discriminant;
  if (!(rising.discriminant >= 0.0)) return roots;
  roots.rising = finite(rising);
  roots.falling = finite(bilinear_root(g, RootKind::falling));
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
  const PairCorners g = corners_of(plane);
  const auto first = bilinear_root(g, RootKind::rising).alpha;
  const auto second = bilinear_root(g, RootKind::falling).alpha;
  return {0.5 * (first[0] + second[0]), 0.5 * (first[1] + second[1])};
}

}  // namespace saltus::switching
