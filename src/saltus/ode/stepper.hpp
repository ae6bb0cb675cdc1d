// One step, of a Runge-Kutta method or of a Taylor series, with error estimate and dense output. Knows no modes and no
// events.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <string_view>
#include <vector>

#include "saltus/base/function_ref.hpp"
#include "saltus/ode/bernstein.hpp"
#include "saltus/ode/nested_polynomial.hpp"
#include "saltus/ode/stages_function.hpp"

namespace saltus::ode {

/// Names the explicit methods of Dormand and Prince; for stiff problems the implicit Radau IIA methods with three, five
/// and seven stages; the Taylor series of the solution where the right-hand side is affine and its linear part is
/// known, and dop853 elsewhere.
enum class Method { dopri5, dop853, radau5, radau9, radau13, taylor };
inline constexpr std::size_t methods = 6;
[[nodiscard]] constexpr std::string_view name(Method method) {
  constexpr std::array<std::string_view, methods> names{"dopri5", "dop853", "radau5", "radau9", "radau13", "taylor"};
  return names[static_cast<std::size_t>(method)];
}

/// Returns whether a method is one of Radau's.
[[nodiscard]] constexpr bool is_implicit(Method method) {
  return method == Method::radau5 || method == Method::radau9 || method == Method::radau13;
}

/// Returns the order of the propagated solution (5, 8, 5, 9, 13, 16) and degree in theta of the dense output (4, 7, 3,
/// 5, 7, 16).
[[nodiscard]] int order(Method method);
[[nodiscard]] int dense_degree(Method method);

/// xdot = f(t, x); x and xdot are n doubles, which do not overlap. A value that is not finite marks a point where f is
/// undefined.
using RightHandSide = FunctionRef<void(double t, const double* x, double* xdot)>;

/// Holds the error weights: atol + rtol |x_i|, both >= 0 and not both 0.
struct Tolerances {
  double rtol = 1e-8;
  double atol = 1e-10;
};

/// Continues one accepted step inside, x(t + theta h), theta in [0, 1]; exact at theta = 0 and 1 (bit for bit), and a
/// component whose slopes are all 0 is exactly constant.
///
/// A value: later steps of the Stepper leave it as it is. Filled again by Stepper::dense it reuses its storage.
class DenseStep {
 public:
  double t = 0.0;
  double h = 0.0;
  void evaluate(double theta, double* x) const;  ///< n doubles
  /// Evaluates one component.
  [[nodiscard]] double value(std::size_t i, double theta) const;
  /// Keeps from now on the part of it from theta = from to `to`, 0 <= from < to <= 1; its end stays where it is if that
  /// is the old one. Not of a series.
  void cut(double from, double to);
  /// Makes component i component k of another one of the same method and interval from now on.
  void replace(std::size_t i, const DenseStep& other, std::size_t k);
  /// Returns Bernstein coefficients of component i on [0, 1]; those at the ends are x_i(t) and x_i(t + h), bit for bit.
  /// The others have a few roundings of the largest one. Cost: some fifty operations. Not of a series.
  [[nodiscard]] BernsteinCoefficients bernstein(std::size_t i) const;
  /// Adds the same in the form that the step is kept in, times a factor, to a sum of such. Not of a series.
  void add_nested(std::size_t i, double factor, NestedPolynomial& sum) const;
  /// Returns whether this is a Taylor series, and the terms of one component: x_i(t + theta h) = sum_k terms_k theta^k.
  [[nodiscard]] bool is_series() const { return method_ == Method::taylor; }
  [[nodiscard]] SeriesCoefficients terms(std::size_t i) const;
  [[nodiscard]] double end(std::size_t i) const { return end_[i]; }  ///< x_i(t + h)
  void derivative(double theta, double* xdot) const;                 ///< dx/dt of the polynomial, n doubles
  /// Bounds low_i <= x_i(t + theta h) <= high_i for all theta in [0, 1], n doubles each, up to rounding: the chord
  /// widened by the largest values of the other terms of the polynomial. Cost: a few operations per component.
  void bounds(double* low, double* high) const;
  [[nodiscard]] int size() const { return n_; }

 private:
  friend class Stepper;
  Method method_ = Method::dopri5;
  int n_ = 0;
  std::vector<double> coefficients_;  ///< of the nested form of Hairer, Norsett & Wanner, II.6, one after the other; or
                                      ///< the terms of a series
  std::vector<double> end_;           ///< x(t + h)
};

enum class Attempt {
  finite,     ///< error_norm() is valid
  undefined,  ///< some stage, or the result, is not finite, or a Radau method does not find its stages: shorten the
              ///< step
};

/// Says what has become of the stages of a Radau method in an attempt.
enum class Stages {
  found,
  undefined,    ///< the right-hand side is, at one of them
  no_jacobian,  ///< the Jacobian is not finite
  singular,     ///< a matrix of Newton's iteration is
  not_found,    ///< it does not converge
};
/// Returns why there are none, in words that go on behind "finds no stages: ".
[[nodiscard]] std::string_view reason(Stages stages);

class Radau;
class Series;
struct ExplicitMethod;
struct ExplicitStep;

/// Holds workspace of one method for n states; allocates in the constructor only (and for a DenseStep filled the first
/// time).
class Stepper {
 public:
  /// @param n  number of states, >= 0
  Stepper(Method method, int n);
  Stepper(Stepper&&) noexcept;
  Stepper& operator=(Stepper&&) noexcept;
  ~Stepper();

  /// Tries a step of length h != 0 from (t, x) with slope = f(t, x).
  ///
  /// x and slope are copied first: they may be x_new() and slope_new() of the attempt before.
  /// With a Radau method the same start may be tried with other lengths; a start at the end of the last attempt
  /// continues it (its polynomial gives starting values, its Jacobian is kept while that pays). So it may with taylor,
  /// which then takes no further products with the linear part.
  /// @param stages  f's stages in one function, if there is one: used in place of f, with the same result bit for bit;
  ///                its linear part, if it has one: used by taylor only, up to the next restart() the same for one
  ///                start
  /// @return `undefined` at the first stage that is not finite, without evaluating the others.
  Attempt attempt(RightHandSide f, double t, const double* x, const double* slope, double h,
                  const Tolerances& tolerances, const RightHandSideStages& stages = {});

  /// Does the same along a polynomial that is known, from its beginning: x_new(), dense() and bounds() are its own,
  /// error_norm() is 0, and there is no slope_new(). It stays where it is until the next attempt.
  void follow(const DenseStep& known, double h);
  /// Returns whether the last attempt was one of these.
  [[nodiscard]] bool follows() const { return known_ != nullptr; }
  /// Returns the polynomial that it has followed to its end; null where it has not.
  [[nodiscard]] const DenseStep* followed() const { return known_ != nullptr && h_ == known_->h ? known_ : nullptr; }

  /// Returns which of the functions attempt() uses, null if none.
  [[nodiscard]] StagesFunction stages_function(const StagesFunctions& functions) const;

  /// Returns whether attempt() has a use for the pattern of the Jacobian.
  [[nodiscard]] bool wants_pattern() const { return radau_ != nullptr; }
  /// Returns whether attempt() has a use for the linear part of an affine right-hand side.
  [[nodiscard]] bool wants_linear_field() const { return series_ != nullptr; }
  /// Returns what the last attempt was made by: taylor, or dop853 in its place, or the method itself.
  [[nodiscard]] Method method() const { return took_series_ ? Method::taylor : pair_; }

  /// Returns the largest component of the local error estimate over atol + rtol max(|x|, |x_new|); <= 1 is acceptable,
  /// infinite if it overflows, never NaN. Valid after a finite attempt.
  [[nodiscard]] double error_norm() const { return error_norm_; }
  [[nodiscard]] const double* x_new() const { return x_new_.data(); }
  /// Returns f(t + h, x_new), n doubles: dopri5's last stage, computed by dop853 too.
  [[nodiscard]] const double* slope_new() const { return stages_.data() + slope_new_; }

  /// Bounds every component of the dense output of the last attempt, which was finite, without computing it; n doubles
  /// each. False where a method has none (Radau). With dop853 they rest on the slopes of the stages: right for
  /// right-hand sides that these resolve, which is what the error estimate assumes too.
  [[nodiscard]] bool bounds(double* low, double* high) const;
  /// Bounds the mean slopes (x_i(t + theta h) - x_i(t)) / (theta h) of that dense output over 0 < theta <= 1, likewise:
  /// they say which components leave their starts in one direction only.
  [[nodiscard]] bool mean_slopes(double* low, double* high) const;
  [[nodiscard]] double start_time() const { return t_; }  ///< of the last attempt
  [[nodiscard]] double length() const { return h_; }      ///< of the last attempt

  /// Evaluates the dense output of the last attempt, which was finite (dop853: three more evaluations of f; `undefined`
  /// if one is not finite, and `output` is then no more than the cubic through both ends with their slopes).
  Attempt dense(RightHandSide f, DenseStep& output);

  /// Notes that the right-hand side has changed: Radau methods and taylor keep nothing of the steps before. No effect
  /// on the explicit pairs.
  void restart();

  /// Returns the length of the last attempt, which was finite, over the one at which an explicit method becomes
  /// unstable. It follows from the two last stages, in units of the tolerances (Hairer & Wanner, Solving Ordinary
  /// Differential Equations II, IV.2). About 1 or more in step after step means that stability, not accuracy, limits
  /// the steps. 0 where that is not known, and for Radau methods.
  [[nodiscard]] double stability_ratio(const Tolerances& tolerances) const;
  /// Returns, of a Radau method, the length of the last attempt over that at which dop853 would become unstable: by the
  /// spectral radius of its Jacobian, which is found better from call to call (power iteration). Cost: two products
  /// with the Jacobian.
  [[nodiscard]] double stability_ratio_of_explicit();
  /// Returns, of a Radau method, what has become of its stages in the last attempt; of others `found`.
  [[nodiscard]] Stages stages() const;
  /// Returns, of a Radau method, the rate of convergence of Newton's iteration in the last attempt; 0 where corrections
  /// were roundings at once.
  [[nodiscard]] double contraction() const;

  /// Returns the largest change of a component in the last attempt, which was finite, in units of its tolerance.
  [[nodiscard]] double change(const Tolerances& tolerances) const;

  [[nodiscard]] long evaluations() const { return evaluations_; }  ///< of f, since construction

 private:
  [[nodiscard]] ExplicitStep explicit_step() const;
  [[nodiscard]] Attempt attempt_series(RightHandSide f, const LinearField& linear, const Tolerances& tolerances);

  Method pair_;  ///< that takes the steps: of taylor the one in its place
  int n_;
  const ExplicitMethod* explicit_;  ///< null: Radau
  std::size_t slope_new_ = 0;       ///< its place in stages_
  double t_ = 0.0;
  double h_ = 0.0;
  double error_norm_ = 0.0;
  long evaluations_ = 0;
  std::vector<double> start_;  ///< x
  std::vector<double> x_new_;
  std::vector<double> argument_;  ///< of the stage being evaluated
  std::vector<double> stages_;    ///< k_1, k_2, ..., n doubles each; Radau: the slopes at both ends
  std::unique_ptr<Radau> radau_;
  std::unique_ptr<Series> series_;
  const DenseStep* known_ = nullptr;  ///< what the last attempt has followed
  bool took_series_ = false;
  bool series_known_ = false;  ///< of start_
};

}  // namespace saltus::ode
