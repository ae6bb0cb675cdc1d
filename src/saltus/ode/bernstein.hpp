// Sign changes of polynomials in Bernstein form on [0, 1]: none is missed.
#pragma once

#include <array>
#include <optional>
#include <span>

namespace saltus::ode {

/// Degree of the interpolants by which event functions are searched; exact for affine functions of the dense output of
/// both methods.
inline constexpr int event_degree = 8;
inline constexpr int event_nodes = event_degree + 1;
using BernsteinCoefficients = std::array<double, event_nodes>;

/// Interpolation nodes in [0, 1], ascending, both ends among them (Chebyshev-Lobatto), and the nodes between them at which
/// an interpolant is checked.
[[nodiscard]] const std::array<double, event_nodes>& interpolation_nodes();
[[nodiscard]] const std::array<double, event_degree>& check_nodes();

/// Bernstein coefficients of the interpolant with the given values at interpolation_nodes(). The end coefficients are the
/// end values bit for bit; scaling the values by a power of two scales the coefficients exactly.
[[nodiscard]] BernsteinCoefficients to_bernstein(std::span<const double, event_nodes> values);

/// Value at theta (de Casteljau).
[[nodiscard]] double evaluate(const BernsteinCoefficients& coefficients, double theta);

/// A bracket [lower, upper] of one sign change: the value's sign is that at 0+ just below `lower`, the other above `upper`.
struct SignChange {
  double lower = 0.0;
  double upper = 0.0;
};

/// The first sign change in (0, 1] of a polynomial whose sign just behind 0 is `sign` (+1 or -1).
///
/// @param coefficients  Bernstein coefficients on [0, 1]
/// @param zero_order    0: the value at 0 is away from zero; 1, 2: the polynomial has a zero of this order at 0, which is
///                      removed exactly (the corresponding leading coefficients are taken as 0) and not found again
/// @param noise         absolute rounding level of the values; anything within it counts as having the expected sign
/// @return the bracket (width <= 2^-40, or the resolution that the noise permits), nullopt if there is none. A touch
///         without a sign change beyond the noise is none.
/// Method: variation diminishing property; subdivision where the coefficients change sign more than once.
[[nodiscard]] std::optional<SignChange> first_sign_change(const BernsteinCoefficients& coefficients, int sign,
                                                          int zero_order, double noise);

}  // namespace saltus::ode
