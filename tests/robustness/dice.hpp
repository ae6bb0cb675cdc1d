// Numbers that depend on a seed only.
#pragma once

#include <cmath>
#include <cstdint>
#include <random>

namespace saltus::robustness {

/// The distributions of the standard library differ between implementations; these do not.
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : random_(seed) {}

  double uniform(double low, double high) {
    return low + (high - low) * static_cast<double>(random_() >> 11) * 0x1p-53;
  }
  std::size_t below(std::size_t count) { return random_() % count; }
  bool chance(double probability) { return uniform(0.0, 1.0) < probability; }
  /// In [-size, size]; for a system of round numbers a multiple of a half, so that things coincide.
  double coefficient(double size) {
    const double value = uniform(-size, size);
    return round_numbers ? 0.5 * std::round(2.0 * value) : value;
  }

  bool round_numbers = false;

 private:
  std::mt19937_64 random_;
};

}  // namespace saltus::robustness
