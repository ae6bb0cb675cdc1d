// The hidden dynamics u_j' = kappa_j g_j(pi(u)) by plain Runge-Kutta steps, pi(u) = min(max(u, 0), 1), until its
// outcome is certain. Shares nothing with the trees.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

namespace saltus::switching {

class HiddenSimulation {
 public:
  using Point = std::array<double, 2>;
  using Fields = std::array<std::array<double, 4>, 2>;

  HiddenSimulation(const Fields& f, const Point& kappa) : f_(f) {
    for (std::size_t j = 0; j < 2; ++j) {
      for (double& velocity : f_[j]) {
        velocity *= kappa[j];
        fastest_ = std::max(fastest_, std::abs(velocity));
      }
    }
  }

  /// The mode the solution from u goes over into; nullopt if it keeps moving for `steps` steps (a limit cycle, mostly).
  [[nodiscard]] std::optional<std::array<int, 2>> outcome(Point u, int steps) const {
    const double h = 0.02 / fastest_;
    for (int n = 0; n < steps; ++n) {
      const Point v = g(u);
      if (leaves(u, v, 0) && leaves(u, v, 1)) return std::array{side(u[0]), side(u[1])};
      for (const std::size_t j : {0U, 1U}) {
        if (side(u[j]) != 0 || side(u[1 - j]) == 0 || !slides(u, v, j)) continue;
        std::array<int, 2> mode{};
        mode[1 - j] = side(u[1 - j]);
        return mode;
      }
      const bool inside = side(u[0]) == 0 && side(u[1]) == 0;
      if (inside && std::abs(v[0]) + std::abs(v[1]) < 1e-12 * fastest_) return std::array{0, 0};
      u = step(u, v, stride(u, v, h));
    }
    return std::nullopt;
  }

 private:
  static int side(double u) { return u > 1.0 ? 1 : u < 0.0 ? -1 : 0; }
  static bool leaves(const Point& u, const Point& v, std::size_t j) { return side(u[j]) * v[j] > 0.0; }

  [[nodiscard]] Point g(const Point& u) const {
    const double x = std::clamp(u[0], 0.0, 1.0);
    const double y = std::clamp(u[1], 0.0, 1.0);
    Point v{};
    for (std::size_t j = 0; j < 2; ++j) {
      v[j] = (1 - x) * (1 - y) * f_[j][0] + x * (1 - y) * f_[j][1] + (1 - x) * y * f_[j][2] + x * y * f_[j][3];
    }
    return v;
  }

  /// In the strip beside the square, u_j is at its attracting equilibrium there and the other component leaves.
  [[nodiscard]] bool slides(const Point& u, const Point& v, std::size_t j) const {
    const std::size_t other = 1 - j;
    Point at = u;
    at[j] = 0.0;
    const double low = g(at)[j];
    at[j] = 1.0;
    const double high = g(at)[j];
    if (!(low > 0.0 && high < 0.0)) return false;
    at[j] = low / (low - high);
    return std::abs(at[j] - u[j]) < 1e-3 && leaves(u, v, other) && leaves(at, g(at), other);
  }

  /// In the corners the velocity is constant: to the edge of the corner at once.
  static double stride(const Point& u, const Point& v, double h) {
    if (side(u[0]) == 0 || side(u[1]) == 0) return h;
    double time = INFINITY;
    for (std::size_t j = 0; j < 2; ++j) {
      const double distance = u[j] > 1.0 ? u[j] - 1.0 : -u[j];
      if (!leaves(u, v, j)) time = std::min(time, distance / std::abs(v[j]));
    }
    return std::max(h, time);
  }

  [[nodiscard]] Point step(const Point& u, const Point& k1, double h) const {
    const auto along = [&u](const Point& k, double s) { return Point{u[0] + s * k[0], u[1] + s * k[1]}; };
    const Point k2 = g(along(k1, 0.5 * h));
    const Point k3 = g(along(k2, 0.5 * h));
    const Point k4 = g(along(k3, h));
    Point next = u;
    for (std::size_t j = 0; j < 2; ++j) next[j] += h / 6.0 * (k1[j] + 2.0 * k2[j] + 2.0 * k3[j] + k4[j]);
    return next;
  }

  Fields f_;
  double fastest_ = 0.0;
};

}  // namespace saltus::switching
