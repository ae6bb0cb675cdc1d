// How the optimal controls change with the states at the nodes: gains of a feedback.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "saltus/solver/solve.hpp"

namespace saltus::solver {

/// Holds what deviations of states and controls from a plan are divided by; infinite: they may be any.
struct TrackingScales {
  std::vector<double> states, controls;
};

/// Returns of each interval the gain K_k = d u_k / d x_k. It says how the first `controls` variables that the interval
/// shares change with the first `states` of its left node. Everything from there on then is optimal again to first
/// order. The sides of all pairs, the active constraints, and the horizon stay as they are. The gain of the first
/// interval is 0, whose node is given.
///
/// They are columns of the inverse of the optimality conditions from node k on. The Riccati recursion over the
/// linearised intervals gives the same. Both diagonals have 1e-9 added, so that rows that depend on each other do no
/// harm.
///
/// With `scales` the gains are those of a controller that tracks the plan instead: it minimises the sum over all
/// intervals behind of (d x / scale)^2 at their ends and (d u / scale)^2, with the sides of the plan. Inequalities and
/// bounds say nothing to it: what is off may be on either side of them.
/// @param problem  with a chain; else there are none
/// Cost: per interval a sparse factorisation of what is behind it.
[[nodiscard]] std::vector<Eigen::MatrixXd> feedback_gains(mpcc::Problem& problem, const Solution& solution,
                                                          int controls, int states,
                                                          const std::optional<TrackingScales>& scales = {});

}  // namespace saltus::solver
