// The regularised system at two surfaces by plain Runge-Kutta steps until its outcome is certain. With fields that are
// constant along the surfaces u = psi / eps makes it the hidden dynamics u_j' = kappa_j g_j(pi(u)), pi(u) = min(max(u,
// 0), 1), whatever eps; fields that drift, g + t dg/dt, change slowly in this time: dt = eps ds. Shares nothing with
// the trees and the resolver.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

namespace saltus::switching {

/// Speeds kappa of the two selections.
inline constexpr std::array<std::array<double, 2>, 3> scalings{{{1.0, 1.0}, {10.0, 1.0}, {1.0, 10.0}}};

class HiddenSimulation {
 public:
  using Point = std::array<double, 2>;
  using Fields = std::array<std::array<double, 4>, 2>;

  struct Outcome {
    /// settled: in `mode`; spirals_out: round the intersection with growing amplitude; moving: neither after all steps.
    enum class Kind { settled, spirals_out, moving } kind = Kind::moving;
    std::array<int, 2> mode{};
  };

  HiddenSimulation(const Fields& f, const Point& kappa) : f_(f), kappa_(kappa) { scale(f_, fastest_); }

  /// Fields f + t rates that pass from t = -before to `before` at the speed eps, and stay there.
  HiddenSimulation(const Fields& f, const Fields& rates, const Point& kappa, double eps, double before)
      : HiddenSimulation(f, kappa) {
    rates_ = rates;
    Point unused{};
    scale(rates_, unused);
    eps_ = eps;
    before_ = before;
  }

  /// Where the solution from u goes over into after at most so many steps.
  [[nodiscard]] Outcome follow(Point u, int steps) const {
    double t = -before_;
    double h = 0.02 / std::max(fastest_[0], fastest_[1]);
    for (int n = 0; n < steps; ++n) {
      const Fields f = at(t);
      const Point v = g(f, u);
      if (t >= before_) {
        if (const auto mode = certain(f, u, v)) return {Outcome::Kind::settled, *mode};
        if (std::max(std::abs(u[0]), std::abs(u[1])) > 1e9) return {Outcome::Kind::spirals_out, {}};
      }
      if (const double jump = to_edge_of_corner(u, v); jump > h && eps_ == 0.0) {
        for (std::size_t j = 0; j < 2; ++j) u[j] += jump * v[j];
        continue;
      }
      step(t, u, v, h);
    }
    return {};
  }

  /// The mode the solution from u goes over into; nullopt if it keeps moving for `steps` steps (a limit cycle, mostly).
  [[nodiscard]] std::optional<std::array<int, 2>> outcome(const Point& u, int steps) const {
    const Outcome found = follow(u, steps);
    return found.kind == Outcome::Kind::settled ? std::optional(found.mode) : std::nullopt;
  }

 private:
  static int side(double u) { return u > 1.0 ? 1 : u < 0.0 ? -1 : 0; }
  static bool leaves(const Point& u, const Point& v, std::size_t j) { return side(u[j]) * v[j] > 0.0; }
  static double outside(double u) { return std::max({u - 1.0, -u, 0.0}); }

  void scale(Fields& f, Point& fastest) const {
    for (std::size_t j = 0; j < 2; ++j) {
      for (double& velocity : f[j]) {
        velocity *= kappa_[j];
        fastest[j] = std::max(fastest[j], std::abs(velocity));
      }
    }
  }

  [[nodiscard]] Fields at(double t) const {
    if (eps_ == 0.0) return f_;
    Fields f = f_;
    for (std::size_t j = 0; j < 2; ++j) {
      for (std::size_t k = 0; k < 4; ++k) f[j][k] += std::min(t, before_) * rates_[j][k];
    }
    return f;
  }

  static Point g(const Fields& f, const Point& u) {
    const double x = std::clamp(u[0], 0.0, 1.0);
    const double y = std::clamp(u[1], 0.0, 1.0);
    Point v{};
    for (std::size_t j = 0; j < 2; ++j) {
      v[j] = (1 - x) * (1 - y) * f[j][0] + x * (1 - y) * f[j][1] + (1 - x) * y * f[j][2] + x * y * f[j][3];
    }
    return v;
  }

  [[nodiscard]] std::optional<std::array<int, 2>> certain(const Fields& f, const Point& u, const Point& v) const {
    if (leaves(u, v, 0) && leaves(u, v, 1)) return std::array{side(u[0]), side(u[1])};
    for (const std::size_t j : {0U, 1U}) {
      if (side(u[j]) != 0 || side(u[1 - j]) == 0 || !slides(f, u, v, j)) continue;
      std::array<int, 2> mode{};
      mode[1 - j] = side(u[1 - j]);
      return mode;
    }
    if (rests(f, u, v)) return std::array{0, 0};
    return std::nullopt;
  }

  /// In the strip beside the square u_j tends monotonically to an attracting equilibrium, on the way to which the
  /// velocity of the other component, affine in u_j, points outwards at both ends.
  static bool slides(const Fields& f, const Point& u, const Point& v, std::size_t j) {
    const std::size_t other = 1 - j;
    Point at = u;
    at[j] = 0.0;
    const double low = g(f, at)[j];
    at[j] = 1.0;
    const double high = g(f, at)[j];
    if (!(low > 0.0 && high < 0.0)) return false;
    at[j] = low / (low - high);
    return leaves(u, v, other) && leaves(at, g(f, at), other);
  }

  /// Inside, at a distance of 1e-5 from a root that is linearly stable under this scaling.
  [[nodiscard]] bool rests(const Fields& f, Point u, Point v) const {
    if (std::abs(v[0]) > 1e-4 * fastest_[0] || std::abs(v[1]) > 1e-4 * fastest_[1]) return false;
    const Point start = u;
    for (int newton = 0; newton < 6; ++newton) {
      if (side(u[0]) != 0 || side(u[1]) != 0) return false;
      const auto slope = [&](std::size_t j, std::size_t p) {
        const std::size_t next = p == 0 ? 1 : 2;
        const double across = u[1 - p];
        return (1.0 - across) * (f[j][next] - f[j][0]) + across * (f[j][3] - f[j][3 - next]);
      };
      const double g11 = slope(0, 0), g12 = slope(0, 1), g21 = slope(1, 0), g22 = slope(1, 1);
      const double determinant = g11 * g22 - g12 * g21;
      if (!(determinant > 0.0) || !(g11 + g22 < 0.0)) return false;
      u[0] -= (g22 * v[0] - g12 * v[1]) / determinant;
      u[1] -= (g11 * v[1] - g21 * v[0]) / determinant;
      v = g(f, u);
    }
    return side(u[0]) == 0 && side(u[1]) == 0 && std::max(std::abs(u[0] - start[0]), std::abs(u[1] - start[1])) < 1e-5;
  }

  /// In the corners the velocity is constant: the time to the edge of the corner; 0 elsewhere.
  static double to_edge_of_corner(const Point& u, const Point& v) {
    if (side(u[0]) == 0 || side(u[1]) == 0) return 0.0;
    double time = INFINITY;
    for (std::size_t j = 0; j < 2; ++j) {
      if (!leaves(u, v, j)) time = std::min(time, outside(u[j]) / std::abs(v[j]));
    }
    return std::isfinite(time) ? time * (1.0 + 1e-12) : 0.0;
  }

  /// One step of the pair of orders 3 and 2 of Bogacki and Shampine with an error below 1e-7, never over the square.
  void step(double& t, Point& u, const Point& k1, double& h) const {
    for (std::size_t j = 0; j < 2; ++j) {
      h = std::min(h, std::max(0.2, 0.9 * outside(u[j])) / std::max(std::abs(k1[j]), 1e-300));
    }
    if (eps_ > 0.0 && t < before_) h = std::min(h, 0.1 * before_ / eps_);
    for (;;) {
      const Point k2 = g(at(t + 0.5 * h * eps_), {u[0] + 0.5 * h * k1[0], u[1] + 0.5 * h * k1[1]});
      const Point k3 = g(at(t + 0.75 * h * eps_), {u[0] + 0.75 * h * k2[0], u[1] + 0.75 * h * k2[1]});
      Point next = u;
      for (std::size_t j = 0; j < 2; ++j) next[j] += h / 9.0 * (2.0 * k1[j] + 3.0 * k2[j] + 4.0 * k3[j]);
      const Point k4 = g(at(t + h * eps_), next);
      double error = 0.0;
      for (std::size_t j = 0; j < 2; ++j) {
        const double difference = h / 72.0 * std::abs(-5.0 * k1[j] + 6.0 * k2[j] + 8.0 * k3[j] - 9.0 * k4[j]);
        error = std::max(error, difference / (1e-7 * (1.0 + outside(u[j]))));
      }
      const double taken = h;
      h *= std::clamp(0.9 * std::cbrt(1.0 / std::max(error, 1e-6)), 0.2, 4.0);
      if (error > 1.0) continue;
      t += taken * eps_;
      u = next;
      return;
    }
  }

  Fields f_;
  Point kappa_;
  Fields rates_{};
  double eps_ = 0.0;
  double before_ = 0.0;
  Point fastest_{};
};

}  // namespace saltus::switching
