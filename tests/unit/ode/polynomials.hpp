// Polynomials given by their zeros, evaluated without cancellation.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "saltus/ode/bernstein.hpp"

namespace saltus::ode::trial {

inline constexpr double resolution = 0x1p-40;  // of sign changes, in theta

/// factor * product of (theta - zero) * product of ((theta - centre)^2 + distance^2), degree at most event_degree.
struct Polynomial {
  struct Pair {
    double centre;
    double distance;
  };
  double factor = 1.0;
  std::vector<double> zeros{};
  std::vector<Pair> pairs{};
  double shift = 0.0;  ///< added to the product

  long double operator()(long double theta) const {
    long double value = factor;
    for (const double zero : zeros) value *= theta - zero;
    for (const Pair& pair : pairs) {
      const long double away = theta - pair.centre;
      value *= away * away + static_cast<long double>(pair.distance) * pair.distance;
    }
    return value + shift;
  }

  [[nodiscard]] BernsteinCoefficients bernstein() const {
    std::array<double, event_nodes> values;
    for (std::size_t i = 0; i < values.size(); ++i) {
      values[i] = static_cast<double>((*this)(interpolation_nodes()[i]));
    }
    return to_bernstein(values);
  }
};

inline double largest(const BernsteinCoefficients& coefficients) {
  double result = 0.0;
  for (const double value : coefficients) result = std::max(result, std::abs(value));
  return result;
}

/// The same numbers on every machine (the distributions of the standard library are not).
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double uniform(double from, double to) {
    return from + (to - from) * (static_cast<double>(engine_() >> 11) * 0x1p-53);
  }
  int integer(int from, int to) {
    return from + static_cast<int>(engine_() % static_cast<std::uint64_t>(to - from + 1));
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace saltus::ode::trial
