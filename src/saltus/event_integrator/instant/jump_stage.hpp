// Jumps at one time: their executions, and what is at zero behind them. Each of these ends the run where it returns
// false.
#pragma once

#include <string>
#include <vector>

#include "saltus/event_integrator/instant/instant_context.hpp"

namespace saltus::event_integrator {

/// Returns their names, for messages.
[[nodiscard]] std::string jump_names(const model::Layout& layout, const std::vector<int>& jumps);
/// Reads the conditions of jumps at the point as it is; returns false where they are wrong.
bool update_jumps(const InstantContext& c);
/// Executes all jumps that are due, one after the other, with what they trigger.
bool execute_due_jumps(const InstantContext& c);
/// Reads conditions for the first time, before the first mode is decided (rule 3), and executes what is due.
bool begin_jumps(const InstantContext& c);
/// Decides the mode behind jumps as at a start (rule 6), into the transition of the cascade.
bool decide_behind_jumps(const InstantContext& c);
/// Checks what follows the jumps: none takes back at once what the motion does, and modes of contacts last.
bool check_behind_jumps(const InstantContext& c);

}  // namespace saltus::event_integrator
