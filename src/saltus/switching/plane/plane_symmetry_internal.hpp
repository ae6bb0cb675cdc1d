// The eight symmetries of the square: reflections of either surface and their exchange.
#pragma once

#include <array>
#include <utility>

#include "saltus/switching/plane/intersection_roots.hpp"
#include "saltus/switching/plane/plane_internal.hpp"

namespace saltus::switching {

/// Returns the roots with the rows as they are in `plane`.
[[nodiscard]] IntersectionRoots intersection_roots(const Plane& plane);

/// Returns where the roots coalesce as the discriminant goes to 0.
[[nodiscard]] PlaneAlpha double_root(const Plane& plane);

/// Changes first the sign of psi_1, then that of psi_2, then exchanges both:
///   reflect_1: f_1'^{k1 k2} = -f_1^{-k1 k2}, f_2'^{k1 k2} = f_2^{-k1 k2};  exchange: f_1'^{k1 k2} = f_2^{k2 k1}.
struct PlaneSymmetry {
  bool reflect_1 = false;
  bool reflect_2 = false;
  bool exchange = false;

  [[nodiscard]] static PlaneSymmetry number(unsigned i) { return {(i & 1U) != 0, (i & 2U) != 0, (i & 4U) != 0}; }

  [[nodiscard]] Plane apply(const Plane& plane) const {
    Plane image;
    const std::size_t reflected = (reflect_1 ? 1U : 0U) + (reflect_2 ? 2U : 0U);
    const std::array<double, 2> sign{reflect_1 ? -1.0 : 1.0, reflect_2 ? -1.0 : 1.0};
    for (std::size_t j = 0; j < 2; ++j) {
      const std::size_t to = exchange ? 1 - j : j;
      image.scale[to] = plane.scale[j];
      image.exponent[to] = plane.exponent[j];
      for (std::size_t k = 0; k < 4; ++k) {
        const std::size_t corner = exchange ? (k & 1U) * 2 + (k >> 1U) : k;
        image.f[to][corner] = sign[j] * plane.f[j][k ^ reflected];
      }
    }
    return image;
  }

  [[nodiscard]] PlaneMode apply(PlaneMode mode) const {
    if (reflect_1) mode[0] = -mode[0];
    if (reflect_2) mode[1] = -mode[1];
    if (exchange) std::swap(mode[0], mode[1]);
    return mode;
  }

  [[nodiscard]] PlaneMode apply_inverse(PlaneMode mode) const {
    if (exchange) std::swap(mode[0], mode[1]);
    if (reflect_1) mode[0] = -mode[0];
    if (reflect_2) mode[1] = -mode[1];
    return mode;
  }

  [[nodiscard]] PlaneAlpha apply(PlaneAlpha alpha) const {
    if (reflect_1) alpha[0] = 1.0 - alpha[0];
    if (reflect_2) alpha[1] = 1.0 - alpha[1];
    if (exchange) std::swap(alpha[0], alpha[1]);
    return alpha;
  }

  [[nodiscard]] SlidingRoot apply(SlidingRoot root) const {
    root.alpha = apply(root.alpha);
    auto& g = root.sliding_jacobian;
    if (reflect_1 != reflect_2) {
      g[0][1] = -g[0][1];
      g[1][0] = -g[1][0];
    }
    if (exchange) {
      std::swap(g[0][0], g[1][1]);
      std::swap(g[0][1], g[1][0]);
    }
    return root;
  }
};

}  // namespace saltus::switching
