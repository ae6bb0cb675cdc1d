// Problems with known solutions and the smallest drivers that integrate them.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "saltus/ode/step_control.hpp"
#include "saltus/ode/stepper.hpp"

namespace saltus::ode::trial {

inline constexpr std::array all_methods{Method::dopri5, Method::dop853, Method::radau5, Method::radau9,
                                        Method::radau13};
inline constexpr std::array radau_methods{Method::radau5, Method::radau9, Method::radau13};
/// How much more of a rounding the transformation of many stages leaves.
inline double rounding_growth(Method method) {
  return method == Method::radau13 ? 16.0 : method == Method::radau9 ? 4.0 : 1.0;
}
inline constexpr std::array explicit_methods{Method::dopri5, Method::dop853};

/// Motion of two bodies with eccentricity e, from the closest point: (q1, q2, v1, v2), period 2 pi.
struct Kepler {
  static constexpr double e = 0.4;
  static constexpr int n = 4;

  void operator()(double /*t*/, const double* x, double* xdot) const {
    const double r2 = x[0] * x[0] + x[1] * x[1];
    const double r3 = r2 * std::sqrt(r2);
    xdot[0] = x[2];
    xdot[1] = x[3];
    xdot[2] = -x[0] / r3;
    xdot[3] = -x[1] / r3;
  }

  [[nodiscard]] static std::vector<double> exact(double t) {
    double anomaly = t;  // Kepler's equation, by Newton
    for (int i = 0; i < 20; ++i) anomaly -= (anomaly - e * std::sin(anomaly) - t) / (1.0 - e * std::cos(anomaly));
    const double minor = std::sqrt(1.0 - e * e);
    const double rate = 1.0 / (1.0 - e * std::cos(anomaly));
    return {std::cos(anomaly) - e, minor * std::sin(anomaly), -std::sin(anomaly) * rate,
            minor * std::cos(anomaly) * rate};
  }
};

inline double distance(const double* a, const std::vector<double>& b) {
  double largest = 0.0;
  for (std::size_t i = 0; i < b.size(); ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
  return largest;
}

struct Trajectory {
  std::vector<double> x;
  int accepted = 0;
  int rejected = 0;
};

/// Equal steps, no error control.
inline std::vector<double> fixed_steps(Method method, RightHandSide f, std::vector<double> x, double t, double end,
                                       int steps) {
  Stepper stepper(method, static_cast<int>(x.size()));
  std::vector<double> slope(x.size());
  const double h = (end - t) / steps;
  f(t, x.data(), slope.data());
  for (int k = 0; k < steps; ++k) {
    stepper.attempt(f, t + k * h, x.data(), slope.data(), h, {});
    std::copy_n(stepper.x_new(), x.size(), x.begin());
    std::copy_n(stepper.slope_new(), x.size(), slope.begin());
  }
  return x;
}

/// Variable steps with error control.
inline Trajectory controlled_steps(Method method, RightHandSide f, std::vector<double> x, double t, double end,
                                   const Tolerances& tolerances) {
  const int n = static_cast<int>(x.size());
  Trajectory run;
  Stepper stepper(method, n);
  StepControl control(method);
  std::vector<double> slope(x.size());
  f(t, x.data(), slope.data());
  double h = initial_step(method, f, t, x.data(), slope.data(), n, end - t, tolerances);
  while (t != end && run.accepted + run.rejected < 100000) {
    const bool last = std::abs(end - t) <= std::abs(h);
    if (last) h = end - t;
    const Attempt attempt = stepper.attempt(f, t, x.data(), slope.data(), h, tolerances);
    if (attempt == Attempt::undefined || stepper.error_norm() > 1.0) {
      ++run.rejected;
      h *= attempt == Attempt::undefined ? 0.25 : control.rejected(stepper.error_norm());
      continue;
    }
    ++run.accepted;
    t = last ? end : t + h;
    std::copy_n(stepper.x_new(), x.size(), x.begin());
    std::copy_n(stepper.slope_new(), x.size(), slope.begin());
    h *= control.accepted(stepper.error_norm());
  }
  run.x = x;
  return run;
}

}  // namespace saltus::ode::trial
