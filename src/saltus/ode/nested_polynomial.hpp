// Polynomials in the form of the dense output, and their first zero where it is plain to see.
#pragma once

#include <array>
#include <cstddef>

namespace saltus::ode {

/// Holds p(theta) = c0 + s (c1 + r (c2 + s (c3 + ...))), s = theta, r = 1 - theta, on [0, 1]: a component of a
/// DenseStep, or a linear combination of components.
struct NestedPolynomial {
  static constexpr std::size_t most = 8;
  std::array<double, most> c{};  ///< the first degree + 1 of them
  int degree = 0;                ///< 3, 4, 5 or 7, those of the methods
  double end = 0.0;              ///< p(1), which is c0 + c1 but for a rounding
};

struct PlainZero {
  enum class Kind {
    none,     ///< first_sign_change finds nothing
    one,      ///< the only zero
    unclear,  ///< one of both, or anything else
  };
  Kind kind = Kind::unclear;
  double theta = 0.0;
  double slope = 0.0;  ///< dp/dtheta there, to eight digits or so
};

/// Finds what first_sign_change looks for, where the Bernstein coefficients of the polynomial's own degree show it.
/// Either none is below the noise on the other side. Or they are beyond it on this side, then within it, then beyond it
/// on the other side, which makes one zero (variation diminishing property). Halley's method then has to converge to it
/// at once, from where the inverse cubic of the ends and their slopes is 0.
/// @param sign        of p just behind 0: +1 or -1
/// @param zero_order  0, or 1: p has a zero at 0, which is removed (c0 is taken as 0); 2 is unclear
/// @param noise       as there; at least eight roundings of the largest coefficient count
/// @return `unclear` for numbers that are not finite. Scaling polynomial and noise by a power of two changes no bit.
/// Cost: some hundred operations.
[[nodiscard]] PlainZero plain_zero(const NestedPolynomial& polynomial, int sign, int zero_order, double noise);

}  // namespace saltus::ode
