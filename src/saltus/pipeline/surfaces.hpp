// The surfaces of a model as a report draws them.
#pragma once

#include <vector>

#include "saltus/pipeline/level_curves.hpp"
#include "saltus/result/result.hpp"

namespace saltus::model {
struct System;
}

namespace saltus::pipeline {

/// Functions whose curves have to be looked for; those beyond are listed without curves.
inline constexpr int most_surfaces_with_curves = 64;

/// Times, both ends of the run among them, at which a curve that moves is drawn.
inline constexpr int times_of_moving_surface = 9;

/// Returns what a drawing of one state shows: its range in the trajectory and a quarter of it on either side; a state
/// that does not move gets room of its own size.
[[nodiscard]] Interval drawn_range(const result::Result& result, int state);

/// Finds where the switching functions and the guards of jumps of `system` are zero and where two of its regions by
/// `indicator` meet. It looks within the range of the trajectory and a quarter of it on either side. Depends on the
/// trajectory, never the other way round: results are the same without. Cost: O(rows n_x); for every function that is
/// not affine and has one state or two about 20 000 evaluations, nine times as many if it moves.
[[nodiscard]] std::vector<result::Surface> surfaces(const model::System& system, const result::Result& result);

}  // namespace saltus::pipeline
