// The verified cases as situations of the hidden dynamics.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "plane_frames.hpp"
#include "saltus/switching/hidden/hidden_dynamics.hpp"
#include "saltus/switching/table/multi_affine.hpp"

namespace saltus::switching {

/// Bilinear interpolation of two rows of four corners; also of the fields of a table.
struct PlaneField {
  Velocities f{};

  void operator()(const double* alpha, double* g) const {
    for (std::size_t j = 0; j < 2; ++j) {
      const double low = (1.0 - alpha[0]) * f[j][0] + alpha[0] * f[j][1];
      const double high = (1.0 - alpha[0]) * f[j][2] + alpha[0] * f[j][3];
      g[j] = (1.0 - alpha[1]) * low + alpha[1] * high;
    }
  }
};

/// The options that make u_j' = kappa_j g_j: the default divides by the largest |g_j|.
inline HiddenOptions plain_scaling(const Velocities& f, std::array<double, 2> kappa) {
  HiddenOptions options;
  for (std::size_t j = 0; j < 2; ++j) {
    double largest = 0.0;
    for (const double value : f[j]) largest = std::max(largest, std::abs(value));
    options.scaling.push_back(kappa[j] * largest);
  }
  return options;
}

/// Sliding on one surface reaches the other.
inline HiddenSituation entering_situation(const Velocities& f, std::array<int, 2> incoming) {
  HiddenSituation situation;
  for (std::size_t j = 0; j < 2; ++j) {
    const std::size_t low = incoming[1 - j] > 0 ? std::size_t{2} >> j : 0;
    situation.arrival.push_back(incoming[j] == 0  ? Arrival::along
                                : incoming[j] < 0 ? Arrival::from_below
                                                  : Arrival::from_above);
    situation.alpha.push_back(incoming[j] == 0 ? f[j][low] / (f[j][low] - f[j][low + 1 + j]) : 0.5);
  }
  return situation;
}

inline HiddenSituation sliding_situation(std::array<double, 2> lambda) {
  return {{Arrival::along, Arrival::along}, {0.5 * (1.0 + lambda[0]), 0.5 * (1.0 + lambda[1])}};
}

}  // namespace saltus::switching
