// Event functions that a sliding mode keeps at their value.
#pragma once

#include "saltus/evaluation/model_kernel.hpp"
#include "saltus/event_integrator/mode/mode_state.hpp"

namespace saltus::event_integrator {

/// Returns whether sliding keeps an event function as it is at (t, x): its gradient in (x, t) is a combination of those
/// of the surfaces that are slid on. Cost: a gradient for each of them, and m^2 n products of those that share a state.
[[nodiscard]] bool is_kept_by_sliding(const evaluation::ModelKernel& kernel, const ModeState& state, int function,
                                      double t, const double* x);

}  // namespace saltus::event_integrator
