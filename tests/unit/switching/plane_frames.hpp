// The eight frames in which the fields at two surfaces can be written.
#pragma once

#include <array>
#include <cstddef>
#include <utility>

namespace saltus::switching {

/// Per surface, the velocities of psi_j in the regions (-,-), (+,-), (-,+), (+,+).
using Velocities = std::array<std::array<double, 4>, 2>;

/// Reflects psi_1, psi_2, and exchanges them, in this order.
struct Relabelling {
  bool reflect_1, reflect_2, exchange;

  explicit Relabelling(unsigned i) : reflect_1((i & 1U) != 0), reflect_2((i & 2U) != 0), exchange((i & 4U) != 0) {}

  template <class T>
  [[nodiscard]] std::array<T, 2> signs(std::array<T, 2> k) const {
    if (reflect_1) k[0] = -k[0];
    if (reflect_2) k[1] = -k[1];
    if (exchange) std::swap(k[0], k[1]);
    return k;
  }

  [[nodiscard]] Velocities fields(const Velocities& f) const {
    Velocities image{};
    for (const int k1 : {-1, 1}) {
      for (const int k2 : {-1, 1}) {
        const auto corner = [](std::array<int, 2> k) { return (k[0] > 0 ? 1U : 0U) + (k[1] > 0 ? 2U : 0U); };
        const std::size_t from = corner({k1, k2});
        const auto vector = signs(std::array<double, 2>{f[0][from], f[1][from]});
        const std::size_t to = corner(signs(std::array<int, 2>{k1, k2}));
        for (std::size_t j = 0; j < 2; ++j) image[j][to] = vector[j];
      }
    }
    return image;
  }
};

}  // namespace saltus::switching
