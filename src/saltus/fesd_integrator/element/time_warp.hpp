// Time inside an element whose solution has no Taylor series at an end.
#pragma once

namespace saltus::fesd_integrator {

/// Warps the time of an element: t(tau) = t_left + h phi(tau), phi' = tau^(a-1) (1-tau)^(b-1) / B(a, b), phi(0) = 0,
/// phi(1) = 1. Behind a crossing of psi = 0 with xdot = f(x, |psi|^(p/q)) the solution is a series in (t -
/// t_left)^(1/q), so one in tau with a = q; before it likewise with b = q. The identity for a = b = 1.
struct TimeWarp {
  int left = 1;   ///< a
  int right = 1;  ///< b

  [[nodiscard]] bool is_none() const { return left == 1 && right == 1; }
  [[nodiscard]] bool operator==(const TimeWarp&) const = default;
  /// Returns phi and its derivative.
  [[nodiscard]] double at(double tau) const;
  [[nodiscard]] double slope(double tau) const;
  /// Returns tau with phi(tau) = theta, 0 <= theta <= 1. Cost: some Newton steps.
  [[nodiscard]] double inverse(double theta) const;
};

/// Returns the smallest q <= `most` for which q * exponent is an integer, or `most` (other exponents have series whose
/// first terms are smooth with that).
[[nodiscard]] int warp_for(double exponent, int most);
/// Returns the largest warp. With more than its number of stages the polynomials of a method are not those of a
/// constant field: d phi / d tau has the degree q - 1. 2 with one stage: without a warp f at the surface, where its
/// derivative is infinite, has a weight.
[[nodiscard]] int most_warped(int stages);

}  // namespace saltus::fesd_integrator
