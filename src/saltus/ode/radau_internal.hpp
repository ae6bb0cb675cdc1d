// One step of a Radau IIA method with three, five or seven stages: Hairer & Wanner, Solving Ordinary Differential
// Equations II, IV.8.
#pragma once

#include <memory>

#include "saltus/ode/sparse/jacobian_pattern.hpp"
#include "saltus/ode/stepper.hpp"

namespace saltus::ode {

/// Holds the step under trial; `x` and `slope` stay as they are during it.
struct RadauTrial {
  RightHandSide f;
  double t;
  double h;
  const double* x;
  const double* slope;
  Tolerances tolerances;
  const JacobianPattern* pattern;    ///< null: dense
  const JacobianFunction* jacobian;  ///< null: differences only
};

/// Takes one step of one of the methods: new value, error estimate, collocation polynomial.
class Radau {
 public:
  virtual ~Radau() = default;

  /// Attempts a step, of which `x_new` and `slope_new` are results, n doubles each; `evaluations` of f are counted up.
  virtual Attempt attempt(const RadauTrial& trial, double* x_new, double* slope_new, long& evaluations) = 0;
  [[nodiscard]] virtual double error_norm() const = 0;
  /// Evaluates coefficients 1 to s of the nested form of the collocation polynomial of the last attempt, s n doubles.
  virtual void dense(double* coefficients) const = 0;
  /// Returns the spectral radius of the Jacobian, after two more products with it than at the last call; infinite where
  /// that is not known.
  [[nodiscard]] virtual double spectral_radius() = 0;
  /// Returns what has become of the stages in the last attempt.
  [[nodiscard]] virtual Stages stages_of_attempt() const = 0;
  /// Returns the rate of convergence of the last iteration.
  [[nodiscard]] virtual double contraction() const = 0;
  /// Forgets the Jacobian and the steps before: the right-hand side has changed.
  virtual void restart() = 0;
};

/// Returns null for methods that are none of these.
[[nodiscard]] std::unique_ptr<Radau> make_radau(Method method, int n);

}  // namespace saltus::ode
