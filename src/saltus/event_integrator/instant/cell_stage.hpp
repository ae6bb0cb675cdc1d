// Ends of cells at an instant: floor, tables, sampled inputs.
#pragma once

#include <vector>

#include "saltus/event_integrator/instant/instant_context.hpp"

namespace saltus::event_integrator {

/// Returns whether ends of cells were located.
[[nodiscard]] bool reaches_cell_end(const EventSearch& search, const Located& located);
/// Moves into the cells behind the ends that were located.
CellChange leave_cells(const InstantContext& c, const Located& located);
/// Returns breaks at which values jump, at this time to rounding.
[[nodiscard]] Located breaks_here(RunState& run);
/// Returns whether time moves the values of surfaces that are held at zero to a higher order: those that hold constants
/// of a cell that is left, or selections of a function of time that is passed.
[[nodiscard]] bool time_moves_surfaces(const InstantContext& c);
/// Decides the mode behind values that time moves, as at a start, into the transition of the outcome. What slides and
/// is still at zero goes on sliding if it can. Returns false where the run ends.
bool decide_behind_times(const InstantContext& c);
/// Looks up arguments that are defined on this side of a surface only. They are so behind it, a few roundings ahead if
/// the surface itself is beside their domain. Returns whether a cell has moved.
bool find_undefined_cells(RunState& run);

}  // namespace saltus::event_integrator
