// Where it pays to look at few states of many.
#pragma once

#include "saltus/evaluation/field_structure.hpp"
#include "saltus/evaluation/model_kernel.hpp"

namespace saltus::event_integrator {

/// Returns what depends on what in f of a large system, null where its rows cannot be evaluated one by one. Of a small
/// one, null too: all of f is evaluated as fast.
inline const evaluation::FieldStructure* structure_of_large(const evaluation::ModelKernel& kernel) {
  constexpr int fewest_states = 64;
  return kernel.states() < fewest_states ? nullptr : kernel.field_structure();
}

}  // namespace saltus::event_integrator
