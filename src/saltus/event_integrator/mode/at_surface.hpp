// Small questions about a point on or beside a surface.
#pragma once

#include <vector>

#include "saltus/evaluation/model_kernel.hpp"
#include "saltus/event_integrator/mode/mode_state.hpp"

namespace saltus::event_integrator {

/// Takes one Newton step of x along the normal onto psi_surface(t, x) = 0: the last bit of way that a field undefined
/// behind its own surface did not permit. x is left where the gradient vanishes or is not finite.
void move_onto(const evaluation::ModelKernel& kernel, const ModeState& state, int surface, double t,
               std::vector<double>& x);

/// Returns what the rounding of an event function at (t, x) is relative to: its magnitude, or what its terms change by
/// over `time_scale` under f(alpha); the latter counts near the origin, where everything is small.
[[nodiscard]] double size_of(const evaluation::ModelKernel& kernel, int function, double t, const double* x,
                             const double* alpha, double time_scale);

/// Returns the sliding surfaces inside a function, ascending. With several of them a group by `indicator` among them
/// has no regions of its own to look into: none then.
[[nodiscard]] std::vector<int> sliding_inside(const evaluation::ModelKernel& kernel, const ModeState& state,
                                              int function);

/// Returns whether a function is around a root of another one, beside the sign of that one: v + abs(x)^p*sign(x).
[[nodiscard]] bool is_around_root(const evaluation::ModelKernel& kernel, int function);

/// Returns the selections of the regions that meet at `surfaces`: those of the mode, with each of these at 0 and at 1.
/// Cost: 2^surfaces, of at most ten of them.
[[nodiscard]] std::vector<std::vector<double>> corners_at(const ModeState& state, const std::vector<int>& surfaces);

/// Returns whether the surface of a function around others is a trajectory of the field of one region beside it
/// (time-optimal feedback). Then the field is tangent to it here and a little further along itself. Looked at over a
/// hundredth of the time in which those others would vanish; false where none of them moves. Cost: six evaluations.
/// @param alpha  of that region
/// @param scale  of velocities of psi_surface: those of the fields of both regions
[[nodiscard]] bool moves_along(const evaluation::ModelKernel& kernel, const std::vector<double>& alpha, int surface,
                               double t, const double* x, double scale);

/// Returns the regions that meet at the sliding surfaces inside a function: of the mode where it slides on one only.
[[nodiscard]] std::vector<std::vector<double>> corners_inside(const evaluation::ModelKernel& kernel,
                                                              const ModeState& state, int function);

/// Returns whether a nested function has the same value in all of these regions at (t, x), to rounding.
/// @param corners     selections of each
/// @param time_scale  a step of the integrator
[[nodiscard]] bool continuous_across(const evaluation::ModelKernel& kernel,
                                     const std::vector<std::vector<double>>& corners, int nested, double t,
                                     const std::vector<double>& x, double time_scale);

}  // namespace saltus::event_integrator
