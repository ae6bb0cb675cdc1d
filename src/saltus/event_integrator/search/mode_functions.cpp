#include "saltus/event_integrator/search/mode_functions.hpp"

namespace saltus::event_integrator {

FunctionParts ModeFunctions::parts_of(const std::vector<std::size_t>& which) const {
  FunctionParts parts;
  for (const std::size_t i : which) {
    if (is_threshold(i)) continue;
    switch (functions[i].kind) {
      case FunctionKind::surface:
      case FunctionKind::user:
      case FunctionKind::cell_upper:
      case FunctionKind::cell_lower:
        parts.phi = true;
        break;
      case FunctionKind::nested:
        parts.nested = true;
        break;
      case FunctionKind::exit_below:
      case FunctionKind::exit_above:
      case FunctionKind::loss:
      case FunctionKind::instability:
        parts.exits = true;
        break;
      case FunctionKind::release:
        parts.pressure = true;
        break;
    }
  }
  return parts;
}

/// Zeros at the start of the mode before are history.
void ModeFunctions::forget_zeros(const std::vector<std::size_t>& special) {
  for (const std::size_t i : special) {
    functions[i].zero_order = 0;
    functions[i].offset = 0.0;
    if (forms.has(i) && functions[i].sign != 0) forms.watch(i, functions[i].sign);
  }
}

/// The sign of a surface outside the mode, which may have a zero here.
void ModeFunctions::turn(std::size_t surface, const ModeState& next, int zero_order) {
  const std::size_t i = of_surface[surface];
  state.mode[surface] = next.mode[surface];
  state.alpha[surface] = next.alpha[surface];
  functions[i].sign = next.mode[surface];
  functions[i].zero_order = zero_order;
  forms.ignore(i);
}

}  // namespace saltus::event_integrator
