// Masses that are positive up to here only.
#pragma once

#include <optional>
#include <string>

#include "saltus/event_integrator/instant/run_state.hpp"

namespace saltus::event_integrator {

/// Returns what to say where steps get short because the mass matrix is positive definite up to here only; nullopt
/// where it is definite beyond.
[[nodiscard]] std::optional<std::string> indefinite_mass_beyond(const RunState& run);

}  // namespace saltus::event_integrator
