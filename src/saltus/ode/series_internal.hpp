// Taylor series of solutions of affine equations, x' = A x + b + c t, to a fixed degree.
#pragma once

#include <cstddef>
#include <vector>

#include "saltus/ode/bernstein.hpp"
#include "saltus/ode/linear_field.hpp"
#include "saltus/ode/stepper.hpp"

namespace saltus::ode {

/// Terms lie by pairs of components, one power after the other, so that two components are one vector register: term k
/// of component i at series_place(i) + 2 k. An odd number of components is filled up with a 0.
inline constexpr std::size_t series_stride = 2 * (series_degree + 1);
[[nodiscard]] constexpr std::size_t series_place(std::size_t i) { return (i / 2) * series_stride + i % 2; }
[[nodiscard]] constexpr std::size_t series_size(std::size_t n) { return (n + 1) / 2 * series_stride; }

/// Evaluates, of the terms a_k = h^k v_k of n components: a_0; sum_k a_k theta^k at theta, its slope, and its bounds on
/// [0, 1].
void series_start(const double* terms, std::size_t n, double* x);
void series_values(const double* terms, std::size_t n, double theta, double* x);
void series_slopes(const double* terms, std::size_t n, double theta, double h, double* xdot);
void series_bounds(const double* terms, std::size_t n, double* low, double* high);

/// Holds the series of one start: x(t + h) = sum_k h^k v_k, v_0 = x, v_1 = f(t, x), 2 v_2 = A v_1 + c, (k + 1) v_(k+1)
/// = A v_k. They do not depend on h, so further lengths from the same start cost a sum. Allocates in the constructor
/// only.
class Series {
 public:
  explicit Series(std::size_t n);

  /// Computes what follows from a start with slope f there; c and A are those of f. NaN and infinity pass on.
  void begin(const LinearField& field, const double* x, const double* slope, double h);
  /// Computes the terms h^k v_k of a length, and their sum.
  void take(double h, double* x_new);
  /// Returns what Stepper says; of the last length.
  [[nodiscard]] double error_norm(const double* x_new, const Tolerances& tolerances) const;
  void bounds(double* low, double* high) const { series_bounds(terms_.data(), n_, low, high); }
  void mean_slopes(double h, double* low, double* high) const;
  [[nodiscard]] double stability_ratio(const Tolerances& tolerances) const;
  /// Returns h^k v_k.
  [[nodiscard]] const std::vector<double>& terms() const { return terms_; }

 private:
  void multiply(const LinearField& field, std::size_t k);
  void keep(std::size_t k);

  std::size_t n_;
  double unit_ = 1.0;           ///< of time: a power of two, so that no bit depends on the length that was tried first
  std::vector<double> scaled_;  ///< unit^k v_k
  std::vector<double> terms_;
  std::vector<double> current_, next_;  ///< unit^k v_k and the following one, n each
};

}  // namespace saltus::ode
