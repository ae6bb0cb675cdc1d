// What a Stepper calls of an explicit Runge-Kutta method: functions made for its number of states, chosen once.
#pragma once

#include <cstddef>

#include "saltus/ode/stepper.hpp"

namespace saltus::ode {

/// Of the code DOP853: on the negative real axis.
inline constexpr double dop853_stability_limit = 6.1;

/// Holds an attempt, made or under way. All vectors have n doubles.
struct ExplicitStep {
  double t;
  double h;
  std::size_t n;
  const double* start;   ///< x(t)
  const double* x_new;   ///< x(t + h)
  const double* stages;  ///< k_1 = f(t, start), k_2, ..., one after the other
};

/// Holds what evaluating its stages needs besides.
struct StageWork {
  RightHandSide f;
  long& evaluations;  ///< counted up
  double* x_new;
  double* stages;
  double* argument;  ///< n doubles, of nobody else
};

/// Holds the operations of Stepper, which says what they mean. Their results do not depend on the n they are made for.
struct ExplicitMethod {
  /// Evaluates the stages behind the first one up to that at x_new, and the error norm (NaN where it overflows); false
  /// at the first stage that is not finite.
  bool (*take)(const ExplicitStep& step, const StageWork& work, const Tolerances& tolerances, double& error_norm);
  /// Evaluates the error norm alone, of a step whose stages are there.
  double (*error_norm)(const ExplicitStep& step, const Tolerances& tolerances);
  void (*bounds)(const ExplicitStep& step, double* low, double* high);
  void (*mean_slopes)(const ExplicitStep& step, double* low, double* high);
  /// Evaluates coefficients of the dense output; false if a further stage is not finite, and then those of the cubic.
  bool (*dense)(const ExplicitStep& step, const StageWork& work, double* coefficients);
  double (*stability_ratio)(const ExplicitStep& step, const Tolerances& tolerances);
  std::size_t last_stage;  ///< f(t + h, x_new) is k_last, counted from 0
  std::size_t stages;      ///< of the dense output
};

/// For 1 to few_states states: n is known to the compiler.
inline constexpr std::size_t few_states = 8;
[[nodiscard]] const ExplicitMethod& dopri5_for_few(std::size_t n);
[[nodiscard]] const ExplicitMethod& dop853_for_few(std::size_t n);

/// Returns the method for any number.
[[nodiscard]] const ExplicitMethod& dopri5_for_any();
[[nodiscard]] const ExplicitMethod& dop853_for_any();

}  // namespace saltus::ode
