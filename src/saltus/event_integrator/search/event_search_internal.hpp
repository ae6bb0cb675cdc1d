// What the sources of the event search share.
#pragma once

#include <array>
#include <cmath>

#include "saltus/event_integrator/search/event_search.hpp"

namespace saltus::event_integrator {

inline int sign_of(double value) { return value > 0.0 ? 1 : value < 0.0 ? -1 : 0; }

/// Returns the sign to which a function that is zero at the start moves; 0 if it stays. By its values or, where these
/// were not sampled, coefficients: of a multiple zero the first ones are roundings of the largest.
template <class Values>
int sign_behind_zero(const Values& values, double noise) {
  for (const double value : values) {
    if (std::abs(value) > noise) return sign_of(value);
  }
  return 0;
}

/// Returns the size of the last two Chebyshev coefficients of an interpolant: what the next ones may be expected to be.
[[nodiscard]] double chebyshev_tail(const std::array<double, ode::event_nodes>& values);

/// Returns whether the function is one of the kernel, not an exit of the mode.
inline bool uses_phi(const EventFunction& function) {
  return function.kind == FunctionKind::surface || function.kind == FunctionKind::user ||
         function.kind == FunctionKind::cell_upper || function.kind == FunctionKind::cell_lower ||
         function.kind == FunctionKind::nested;
}

}  // namespace saltus::event_integrator
