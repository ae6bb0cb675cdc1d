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

/// What the rounding of an event function at (t, x) is relative to: its magnitude, or what its terms change by over
/// `time_scale` under f(alpha); the latter counts near the origin, where everything is small.
[[nodiscard]] double size_of(const evaluation::ModelKernel& kernel, int function, double t, const double* x,
                             const double* alpha, double time_scale);

/// Whether a function nested around the one sliding surface has the same value on both sides of it at (t, x), to
/// rounding.
/// @param time_scale  a step of the integrator
[[nodiscard]] bool continuous_across(const evaluation::ModelKernel& kernel, const ModeState& state, int nested,
                                     double t, const std::vector<double>& x, double time_scale);

}  // namespace saltus::event_integrator
