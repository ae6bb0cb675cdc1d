#include "saltus/fesd_integrator/element/time_warp.hpp"

#include <algorithm>
#include <cmath>

namespace saltus::fesd_integrator {
namespace {

double power(double base, int exponent) {
  double product = 1.0;
  for (int i = 0; i < exponent; ++i) product *= base;
  return product;
}

/// 1 / B(a, b) = a binomial(a + b - 1, b - 1) for integers.
double inverse_beta(int a, int b) {
  double value = a;
  for (int k = 1; k < b; ++k) value = value * (a + k) / k;
  return value;
}

/// The incomplete beta function up to tau <= 1/2, where the sum has no cancellation to speak of.
double lower_part(int a, int b, double tau) {
  double sum = 0.0, coefficient = 1.0;  // of tau^k in (1 - tau)^(b - 1)
  for (int k = 0; k < b; ++k) {
    sum += coefficient * power(tau, k) / (a + k);
    coefficient *= -static_cast<double>(b - 1 - k) / (k + 1);
  }
  return inverse_beta(a, b) * power(tau, a) * sum;
}

}  // namespace

double TimeWarp::at(double tau) const {
  if (is_none()) return tau;
  return tau <= 0.5 ? lower_part(left, right, tau) : 1.0 - lower_part(right, left, 1.0 - tau);
}

double TimeWarp::slope(double tau) const {
  if (is_none()) return 1.0;
  return inverse_beta(left, right) * power(tau, left - 1) * power(1.0 - tau, right - 1);
}

double TimeWarp::inverse(double theta) const {
  if (is_none()) return theta;
  if (theta <= 0.0) return 0.0;
  if (theta >= 1.0) return 1.0;
  double lower = 0.0, upper = 1.0, tau = 0.5;
  constexpr int most_iterations = 100;
  for (int i = 0; i < most_iterations; ++i) {
    const double value = at(tau) - theta;
    (value > 0.0 ? upper : lower) = tau;
    const double newton = tau - value / slope(tau);
    const double next = newton > lower && newton < upper ? newton : 0.5 * (lower + upper);
    if (next == tau || value == 0.0) return tau;
    tau = next;
  }
  return tau;
}

int warp_for(double exponent, int most) {
  constexpr double rounding = 1e-12;
  for (int q = 2; q <= most; ++q) {
    if (std::abs(q * exponent - std::round(q * exponent)) <= rounding) return q;
  }
  return most;
}

int most_warped(int stages) {
  constexpr int most = 4;
  return std::min(stages, most);
}

}  // namespace saltus::fesd_integrator
