// Projected fields of two surfaces, uniform in [-1, 1].
#pragma once

#include <random>

#include "plane_frames.hpp"

namespace saltus::switching {

class RandomFields {
 public:
  explicit RandomFields(unsigned seed) : random_(seed) {}

  double uniform() { return distribution_(random_); }

  Velocities fields() {
    Velocities f{};
    for (auto& row : f) {
      for (double& velocity : row) velocity = uniform();
    }
    return f;
  }

  /// Turning counterclockwise around the intersection: the signs (4.14) of [guglielmi2022].
  Velocities spiral() {
    Velocities f = fields();
    constexpr std::array<std::array<double, 4>, 2> signs{{{1, 1, -1, -1}, {-1, 1, -1, 1}}};
    for (std::size_t j = 0; j < 2; ++j) {
      for (std::size_t k = 0; k < 4; ++k) f[j][k] = signs[j][k] * (0.05 + std::abs(f[j][k]));
    }
    return f;
  }

 private:
  std::mt19937 random_;
  std::uniform_real_distribution<double> distribution_{-1.0, 1.0};
};

}  // namespace saltus::switching
