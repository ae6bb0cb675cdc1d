// Sign changes of polynomials in Bernstein form on [0, 1]: none is missed.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>

namespace saltus::ode {

/// Degree of the interpolants by which event functions are searched; exact for affine functions of the dense output of
/// both methods.
inline constexpr int event_degree = 8;
inline constexpr int event_nodes = event_degree + 1;
using BernsteinCoefficients = std::array<double, event_nodes>;

/// Degree of Taylor series, and of affine functions along them.
inline constexpr int series_degree = 16;
using SeriesCoefficients = std::array<double, series_degree + 1>;

/// Returns interpolation nodes in [0, 1], ascending, both ends among them (Chebyshev-Lobatto), and the nodes between
/// them at which an interpolant is checked.
[[nodiscard]] const std::array<double, event_nodes>& interpolation_nodes();
[[nodiscard]] const std::array<double, event_degree>& check_nodes();

/// Returns Bernstein coefficients of the interpolant with the given values at interpolation_nodes(). The end
/// coefficients are the end values bit for bit; scaling the values by a power of two scales the coefficients exactly.
///
/// Accuracy: the result is the exact interpolant of values changed by a few roundings of the largest coefficient;
/// single coefficients amplify errors of the values by up to 184, values of the polynomial by less than 3.
[[nodiscard]] BernsteinCoefficients to_bernstein(std::span<const double, event_nodes> values);

/// Evaluates the value (de Casteljau), and derivative with respect to theta, at theta in [0, 1].
[[nodiscard]] double evaluate(const BernsteinCoefficients& coefficients, double theta);
[[nodiscard]] double evaluate(const SeriesCoefficients& coefficients, double theta);
[[nodiscard]] double derivative(const BernsteinCoefficients& coefficients, double theta);
[[nodiscard]] double derivative(const SeriesCoefficients& coefficients, double theta);

/// Returns Bernstein coefficients on [0, 1] of sum_k terms_k theta^k.
///
/// Accuracy: every coefficient is a sum of parts of the terms; its error is below series_rounding times the sum of
/// their sizes. Scaling the terms by a power of two scales the coefficients exactly.
[[nodiscard]] SeriesCoefficients to_bernstein(const SeriesCoefficients& terms);
/// A sum of series_degree + 1 products: as many half units, and one for the table.
inline constexpr double series_rounding = (series_degree + 2) * 0x1p-53;
/// Returns the same polynomial on [from, to], 0 <= from < to <= 1, as coefficients on [0, 1].
[[nodiscard]] SeriesCoefficients part_of(const SeriesCoefficients& coefficients, double from, double to);

/// Holds a bracket [lower, upper] of one sign change: the value's sign is that at 0+ just below `lower`, the other
/// above `upper`.
struct SignChange {
  double lower = 0.0;
  double upper = 0.0;
};

/// Returns whether coefficients are beyond the noise at first, then within it, then beyond it on the other side. Then
/// the polynomial falls through the noise once (variation diminishing property). Behind a zero at 0 of the order
/// `begin` the first coefficients, which are 0, do not count. False for NaN.
template <std::size_t nodes>
[[nodiscard]] inline bool falls_once(const std::array<double, nodes>& b, double noise, std::size_t begin = 0) {
  if (!(b.back() < -noise)) return false;
  std::size_t k = begin;
  while (k < nodes && b[k] > noise) ++k;
  if (k == begin) return false;
  while (k < nodes && b[k] >= -noise && b[k] <= noise) ++k;
  if (k == nodes) return false;
  while (k < nodes && b[k] < -noise) ++k;
  return k == nodes;
}

/// Returns true only if first_sign_change finds nothing with the same arguments: no coefficient is beyond the noise on
/// the other side. The cheap way out for almost every event function in almost every step; false for NaN.
template <std::size_t nodes = event_nodes>
[[nodiscard]] inline bool certainly_no_sign_change(const std::array<double, nodes>& coefficients, int sign,
                                                   int zero_order, double noise) {
  const double side = sign > 0 ? 1.0 : -1.0;
  int beyond = 0;  // not a bool with early exit: nine comparisons without a branch
  for (std::size_t i = 0; i < coefficients.size(); ++i) {
    const int counts = static_cast<int>(i) >= zero_order ? 1 : 0;
    beyond |= side * coefficients[i] >= -noise ? 0 : counts;
  }
  return beyond == 0;
}

/// Finds the first sign change in (0, 1] of a polynomial whose sign just behind 0 is `sign` (+1 or -1).
///
/// A sign change is a zero. Behind it the value is beyond the noise on the other side before it is beyond the noise on
/// the first side again. So a touch is none, nor is a value at 1 within the noise: the next step, which starts there
/// with the same expected sign, finds that one.
///
/// @param coefficients  Bernstein coefficients on [0, 1], finite
/// @param zero_order    0: the value at 0 has the expected sign or is within the noise; 1 to 3: the polynomial has a
///                      zero of this order at 0, which is removed exactly (the corresponding leading coefficients are
///                      taken as 0) and not found again
/// @param noise         absolute rounding level of the values, >= 0; anything within it counts as having the expected
///                      sign (a dip that exceeds it by less than a sixteenth may count as within it)
/// @return the bracket (width <= 2^-40, or the resolution that the noise permits), nullopt if there is none. It
///         begins at 0 where the value there is on the other side already (within the noise, or beyond it: {0, 0}).
///         Scaling coefficients and noise by a power of two changes no bit.
/// Cost: no allocation; a few microseconds where there is a sign change.
/// Method: variation diminishing property; bisection where the coefficients change sign more than once.
[[nodiscard]] std::optional<SignChange> first_sign_change(const BernsteinCoefficients& coefficients, int sign,
                                                          int zero_order, double noise);
[[nodiscard]] std::optional<SignChange> first_sign_change(const SeriesCoefficients& coefficients, int sign,
                                                          int zero_order, double noise);
/// Returns the same for the polynomial with these terms, sum_k terms_k theta^k, in less time.
[[nodiscard]] std::optional<SignChange> first_sign_change(const SeriesCoefficients& coefficients,
                                                          const SeriesCoefficients& terms, int sign, int zero_order,
                                                          double noise);

}  // namespace saltus::ode
