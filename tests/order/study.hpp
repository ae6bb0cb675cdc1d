// What order tests have in common: the methods, and the line through the logarithms of errors.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "saltus/pipeline/options/simulate_options.hpp"

namespace saltus::problems {

/// A Runge-Kutta method of finite elements, and its order.
struct RungeKutta {
  const char* name;
  pipeline::Scheme scheme;
  long stages;
  double order;
};

inline constexpr std::array<RungeKutta, 8> runge_kutta_methods{{{"RadauIIA1", pipeline::Scheme::radau_iia, 1, 1},
                                                                {"RadauIIA2", pipeline::Scheme::radau_iia, 2, 3},
                                                                {"RadauIIA3", pipeline::Scheme::radau_iia, 3, 5},
                                                                {"RadauIIA4", pipeline::Scheme::radau_iia, 4, 7},
                                                                {"Gauss1", pipeline::Scheme::gauss_legendre, 1, 2},
                                                                {"Gauss2", pipeline::Scheme::gauss_legendre, 2, 4},
                                                                {"Gauss3", pipeline::Scheme::gauss_legendre, 3, 6},
                                                                {"Gauss4", pipeline::Scheme::gauss_legendre, 4, 8}}};

/// Errors over numbers of steps, and the line through their logarithms.
struct Study {
  std::vector<double> steps, errors;

  void add(long n, double error) {
    steps.push_back(static_cast<double>(n));
    errors.push_back(error);
  }
  [[nodiscard]] double largest() const { return *std::max_element(errors.begin(), errors.end()); }
  /// Errors below it are roundings and those of the reference.
  double rounding = 2e-12;
  [[nodiscard]] std::size_t usable() const {
    return static_cast<std::size_t>(
        std::count_if(errors.begin(), errors.end(), [this](double e) { return e > rounding; }));
  }
  /// Least squares of log(error) over log(1 / steps).
  [[nodiscard]] double slope() const {
    double n = 0.0, mean_x = 0.0, mean_y = 0.0, covariance = 0.0, variance = 0.0;
    const auto each = [&](auto use) {
      for (std::size_t i = 0; i < steps.size(); ++i) {
        if (errors[i] > rounding) use(-std::log(steps[i]), std::log(errors[i]));
      }
    };
    each([&](double x, double y) {
      n += 1.0;
      mean_x += x;
      mean_y += y;
    });
    mean_x /= n;
    mean_y /= n;
    each([&](double x, double y) {
      covariance += (x - mean_x) * (y - mean_y);
      variance += (x - mean_x) * (x - mean_x);
    });
    return covariance / variance;
  }
  /// The first errors only, down to where they are roundings.
  void stop_at_rounding() {
    const auto end = std::find_if(errors.begin(), errors.end(), [this](double e) { return e <= rounding; });
    steps.resize(static_cast<std::size_t>(end - errors.begin()));
    errors.erase(end, errors.end());
  }
  /// The largest error of each `size` levels in a row, at the middle of their steps: where a switch lies in its
  /// simulation step decides how long the elements around it are, and errors scatter below this.
  [[nodiscard]] Study envelope(std::size_t size) const {
    Study largest_ones;
    largest_ones.rounding = rounding;
    for (std::size_t first = 0; first + size <= steps.size(); first += size) {
      const auto begin = static_cast<std::ptrdiff_t>(first), end = static_cast<std::ptrdiff_t>(first + size);
      largest_ones.steps.push_back(std::sqrt(steps[first] * steps[first + size - 1]));
      largest_ones.errors.push_back(*std::max_element(errors.begin() + begin, errors.begin() + end));
    }
    return largest_ones;
  }
  [[nodiscard]] std::string table() const {
    std::string text;
    for (std::size_t i = 0; i < steps.size(); ++i) {
      text += std::to_string(std::lround(steps[i])) + " steps: " + std::to_string(std::log10(errors[i])) + "\n";
    }
    return text;
  }
};

}  // namespace saltus::problems
