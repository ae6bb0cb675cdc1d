// How controls change with the states at starts of elements: gains of a feedback.
#pragma once

#include <optional>
#include <vector>

#include "saltus/linalg/matrix.hpp"
#include "saltus/solver/solve.hpp"

namespace saltus::solver {

/// Holds what deviations of states and controls from a plan are divided by; infinite: they may be any.
struct TrackingScales {
  std::vector<double> states, controls;
};

/// Returns of each element the gain K = d u_k / d x at its start, none (0 x 0) where nothing is corrected.
///
/// It says how the first `controls` variables that interval k shares change with the first `states` there, until the
/// interval ends. The sides of all pairs and the horizon stay as they are. The gain of the first element is 0, whose
/// start is given.
///
/// Without `scales` only the first elements of intervals have gains: everything from the node on then is optimal again
/// to first order, with the same active constraints. With `scales` all elements have those of a controller that tracks
/// the plan instead: it minimises the sum of (d u / scale)^2 over this interval and those behind, and of
/// (d x / scale)^2 at their ends. Inequalities and bounds say nothing to it: what is off may be on either side of them.
///
/// They are columns of the inverse of the optimality conditions of what is behind. The Riccati recursion over the
/// linearised intervals gives the same. Both diagonals have 1e-9 added, so that rows that depend on each other do no
/// harm.
/// @param problem  with a chain; else there are none
/// Cost: per gain a sparse factorisation of what is behind it.
[[nodiscard]] std::vector<linalg::Matrix> feedback_gains(mpcc::Problem& problem, const Solution& solution, int controls,
                                                         int states, const std::optional<TrackingScales>& scales = {});

}  // namespace saltus::solver
