// The stages of an explicit step by one function, made for one right-hand side: nothing is called between them.
#pragma once

#include "saltus/base/function_ref.hpp"
#include "saltus/ode/linear_field.hpp"
#include "saltus/ode/sparse/jacobian_pattern.hpp"

namespace saltus::ode {

/// As Stepper::attempt evaluates them, bit for bit: from x, h and k_1, which is there, the stages k_2, k_3, … up to the
/// one at x_new, n doubles each, and x_new. `data` is what the function was made to know of its right-hand side.
/// @return the number of stages evaluated; less than 0, -1 less that number, where one or its argument is not finite
using StagesFunction = int (*)(double t, double h, const double* x, const void* data, double* stages, double* x_new);

/// Holds one for each method; null where there is none.
struct StagesFunctions {
  StagesFunction dopri5 = nullptr;
  StagesFunction dop853 = nullptr;
};

/// Evaluates the Jacobian at (t, x): entries in the order of the pattern, or all of them column by column without one.
/// @return false where it is not known, or not finite
using JacobianFunction = FunctionRef<bool(double t, const double* x, double* entries)>;

/// Holds what is known of a right-hand side beside its values: its stages, with their data, and its linear part if it
/// is affine. Used by Radau methods only: the pattern of its Jacobian, where that has few entries, for as long as it
/// has the same address; the Jacobian itself, for where differences fail.
struct RightHandSideStages {
  StagesFunctions functions;
  const void* data = nullptr;
  const LinearField* linear = nullptr;
  const JacobianPattern* pattern = nullptr;
  const JacobianFunction* jacobian = nullptr;
};

}  // namespace saltus::ode
