// One explicit Runge-Kutta step with error estimate and dense output. Knows no modes and no events.
#pragma once

#include <vector>

#include "saltus/base/function_ref.hpp"

namespace saltus::ode {

enum class Method { dopri5, dop853 };

/// Order of the propagated solution (5, 8) and degree in theta of the dense output (4, 7).
[[nodiscard]] int order(Method method);
[[nodiscard]] int dense_degree(Method method);

/// xdot = f(t, x); x and xdot are n doubles. A value that is not finite marks a point where f is undefined.
using RightHandSide = FunctionRef<void(double t, const double* x, double* xdot)>;

/// Error weights: atol + rtol |x_i|. Components of `weight_mask` (empty = all) that are 0 take no part.
struct Tolerances {
  double rtol = 1e-8;
  double atol = 1e-10;
};

/// Continuous extension of one accepted step, x(t + theta h), theta in [0, 1]; exact at theta = 0 and 1 (bit for bit), and
/// a component whose slopes are all 0 is exactly constant.
class DenseStep {
 public:
  double t = 0.0;
  double h = 0.0;
  void evaluate(double theta, double* x) const;         ///< n doubles
  void derivative(double theta, double* xdot) const;    ///< dx/dt of the polynomial, n doubles
  [[nodiscard]] int size() const;

 private:
  friend class Stepper;
  Method method_ = Method::dopri5;
  int n_ = 0;
  std::vector<double> coefficients_;  ///< of the nested form of Hairer, Norsett & Wanner, II.6
  std::vector<double> end_;           ///< x(t + h)
};

enum class Attempt {
  finite,     ///< error_norm() is valid
  undefined,  ///< some stage, or the result, is not finite: shorten the step
};

/// Workspace of one method for n states; allocates in the constructor only.
class Stepper {
 public:
  Stepper(Method method, int n);

  /// Tries a step of length h != 0 from (t, x) with slope = f(t, x).
  Attempt attempt(RightHandSide f, double t, const double* x, const double* slope, double h, const Tolerances& tolerances);

  /// Root mean square of the local error estimate over atol + rtol max(|x|, |x_new|); <= 1 is acceptable.
  [[nodiscard]] double error_norm() const;
  [[nodiscard]] const double* x_new() const;
  [[nodiscard]] const double* slope_new() const;  ///< f(t + h, x_new): dopri5's last stage, computed by dop853 too

  /// Dense output of the last attempt (dop853: three more evaluations of f; `undefined` if one is not finite).
  Attempt dense(RightHandSide f, DenseStep& output);

  [[nodiscard]] long evaluations() const;  ///< of f, since construction

 private:
  Method method_;
  int n_;
  // stages, error, result …
};

}  // namespace saltus::ode
