#include "saltus/event_integrator/search/mode_functions.hpp"

#include <algorithm>

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
      case FunctionKind::absent:
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

/// A surface that has changed its mode, or has a zero here.
void ModeFunctions::turn(std::size_t surface, const ModeState& next, int zero_order) {
  const int mode = next.mode[surface];
  state.mode[surface] = mode;
  state.alpha[surface] = next.alpha[surface];
  forms.ignore(surface);
  const int j = functions[surface].index;
  if (mode == 0) {
    put(surface, {FunctionKind::absent, j});
  } else {
    put(surface, {FunctionKind::surface, j, 0, mode, zero_order});
    for (const std::size_t exit : {exit_of(surface), exit_of(surface) + 1}) {
      if (functions[exit].kind == FunctionKind::absent) continue;
      forms.ignore(exit);
      put(exit, {FunctionKind::absent, j});
      list_curved(exit);
    }
  }
  list_curved(surface);
}

void ModeFunctions::put(std::size_t place, const EventFunction& function) {
  const auto counts = [](const EventFunction& entry) { return entry.kind == FunctionKind::absent ? 0U : 1U; };
  present += counts(function);
  present -= counts(functions[place]);
  functions[place] = function;
}

void ModeFunctions::list_curved(std::size_t place) {
  const bool is_curved = functions[place].kind != FunctionKind::absent && !forms.has(place);
  const auto known = std::lower_bound(curved.begin(), curved.end(), place);
  const bool listed = known != curved.end() && *known == place;
  if (is_curved && !listed) curved.insert(known, place);
  if (!is_curved && listed) curved.erase(known);
}

}  // namespace saltus::event_integrator
