// Layers around surfaces in which the right-hand side is stiff and continuous, and what errors they allow.
#pragma once

#include "saltus/evaluation/model_kernel.hpp"
#include "saltus/event_integrator/mode/mode_state.hpp"
#include "saltus/event_integrator/options.hpp"

namespace saltus::event_integrator {

/// Returns the tolerances of a mode that begins at (t, x), lowered where that is inside of layers or at their edge.
/// There atol and rtol each leave an error of at most 1/10000 of the layer's half width in its psi. An error of a part
/// of the width is one of that part in alpha, hence in the right-hand side. So a solution that leaves a layer slowly
/// may seem to come back. Where tolerances do not see the layer, a run ends somewhere else and says nothing.
[[nodiscard]] ode::Tolerances within_layers(const evaluation::ModelKernel& kernel, const ThinLayers& layers,
                                            const ode::Tolerances& wanted, const ModeState& state, double t,
                                            const double* x);

}  // namespace saltus::event_integrator
