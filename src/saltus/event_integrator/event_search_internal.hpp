// What the two sources of the event search share.
#pragma once

#include "saltus/event_integrator/event_search.hpp"

namespace saltus::event_integrator {

inline int sign_of(double value) { return value > 0.0 ? 1 : value < 0.0 ? -1 : 0; }

/// Whether the function is one of the kernel, not an exit of the mode.
inline bool uses_phi(const EventFunction& function) {
  return function.kind == FunctionKind::surface || function.kind == FunctionKind::user ||
         function.kind == FunctionKind::cell_upper || function.kind == FunctionKind::cell_lower ||
         function.kind == FunctionKind::nested_below || function.kind == FunctionKind::nested_above;
}

}  // namespace saltus::event_integrator
