// Rows of the trajectory around an instant.
#pragma once

#include "saltus/base/function_ref.hpp"
#include "saltus/event_integrator/instant/instant_context.hpp"

namespace saltus::event_integrator {

/// Notes what is here before an instant, the selections of a sliding mode among it.
void arrive(const InstantContext& c, bool row_is_written);
/// Calls write() with cells and activities as they were before the instant.
void in_mode_before(const InstantContext& c, FunctionRef<void()> write);
/// Writes the rows before and behind what has happened, if that asks for any.
void write_rows(const InstantContext& c);
/// Skips to the limit of a sequence that is too fine to be followed; rows on the way have the last state.
void pass_to(RunState& run, double t, const std::vector<double>& x);

}  // namespace saltus::event_integrator
