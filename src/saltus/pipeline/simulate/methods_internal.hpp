// The ways to a trajectory.
#pragma once

#include "saltus/base/error.hpp"
#include "saltus/event_integrator/options.hpp"
#include "saltus/pipeline/simulate.hpp"
#include "saltus/pipeline/simulate/simulation_internal.hpp"
#include "saltus/result/result.hpp"

namespace saltus::pipeline {

/// Follows the system from event to event, and its branches.
[[nodiscard]] Expected<result::Result> simulate_event(const Simulation& asked, KernelStore& kernels);

/// Follows its regularisation, and says it of the system itself.
[[nodiscard]] Expected<result::Result> simulate_smoothed(const Simulation& asked, KernelStore& kernels);

/// Reformulates the system and solves elements, with switch detection or without.
[[nodiscard]] Expected<result::Result> simulate_elements(const Simulation& asked);

/// Does so with the frozen form of a system with contacts or hysteresis, until its clock shows the end.
/// @return the result in physical time, or why the system cannot be frozen
[[nodiscard]] Expected<result::Result> simulate_frozen(const Simulation& asked);

/// Returns what the event engine is asked for, but for choices and layers.
[[nodiscard]] event_integrator::IntegrationOptions event_options(const Simulation& asked, Integrator method);

}  // namespace saltus::pipeline
