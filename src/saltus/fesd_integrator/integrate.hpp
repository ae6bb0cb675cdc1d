// Finite elements with switch detection: from an initial state through all switches and sliding phases to the end.
#pragma once

#include "saltus/base/error.hpp"
#include "saltus/fesd_integrator/integration.hpp"

namespace saltus::model {
struct System;
}
namespace saltus::reformulation {
struct Dcs;
}

namespace saltus::fesd_integrator {

/// Solves the equations of FESD, (37)-(41) of [nurkanovic2024], one simulation step of length T = (until - from) /
/// steps after the other. They are square once the active set of every element is fixed, which is predicted and
/// repaired. Within a simulation step the elements between two switches have equal lengths (exact step equilibration).
/// Where sliding ends, psi is zero on both sides of the boundary and the equations leave its place open; it is closed
/// by alpha = 0 or 1 there (alpha of the projected field), where d psi / dt of the other side is zero.
/// @return everything computed up to the termination; never throws for numerical reasons. An Error only if the symbolic
///         layer refuses an expression, or native code is insisted on and cannot be had. An Error, too, if
///         sensitivities are asked for and the field has roots of what is zero on a surface.
/// Cost: per element a Newton iteration on n_s (n_x + n_sliding) unknowns; per switch some solutions of the elements
///       before it.
[[nodiscard]] Expected<Integration> integrate(const model::System& system, const reformulation::Dcs& dcs,
                                              const IntegrationOptions& options, const StepObserver& observer = {});

}  // namespace saltus::fesd_integrator
