// What the native stages of steps are made for: the field of a region, and sliding on one surface.
#pragma once

#include "saltus/ode/stages_function.hpp"

namespace saltus::evaluation {

/// Is sliding on one surface with a constant gradient, between two fields f-, f+ which differ in their constants:
///   xdot = f- + s (f+ - f-),  s = g- / (g- - g+),  g = row . f + rate,  less its rounding normal to the surface.
/// Laid out as the C code declares it.
struct SlidingConstants {
  const double* below = nullptr;  ///< constants of f-
  const double* above = nullptr;  ///< constants of f+
  const double* row = nullptr;    ///< n doubles
  double rate = 0.0;
  double row_square = 0.0;  ///< |row|^2
  long only = -1;           ///< the only component of the row that is not 0, or -1
};

/// Holds stages along the field of constants (their data), and along SlidingConstants (theirs).
struct NativeSteps {
  ode::StagesFunctions field, sliding;
};

}  // namespace saltus::evaluation
