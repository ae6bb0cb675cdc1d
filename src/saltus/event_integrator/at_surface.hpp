// Small questions about a point on or beside a surface.
#pragma once

#include <vector>

#include "saltus/evaluation/model_kernel.hpp"
#include "saltus/event_integrator/mode_state.hpp"

namespace saltus::event_integrator {

/// One Newton step of x along the normal onto psi_surface(t, x) = 0: the last bit of way that a field undefined behind
/// its own surface did not permit. x is left where the gradient vanishes or is not finite.
void move_onto(const evaluation::ModelKernel& kernel, const ModeState& state, int surface, double t,
               std::vector<double>& x);

/// Whether a function nested around the one sliding surface has the same value on both sides of it at (t, x), to
/// rounding.
[[nodiscard]] bool continuous_across(const evaluation::ModelKernel& kernel, const ModeState& state, int nested,
                                     double t, const std::vector<double>& x);

}  // namespace saltus::event_integrator
