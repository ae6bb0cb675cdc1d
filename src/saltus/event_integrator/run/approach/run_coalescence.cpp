// Sliding on several surfaces towards a point at which its root meets another one.
#include <algorithm>

#include "saltus/event_integrator/run/run_internal.hpp"

namespace saltus::event_integrator {

/// The tolerances of a step: those of the mode, and the parts of them that shrinking laps, near roots of sliding and
/// roots of switching functions leave.
void Run::set_tolerances() {
  tolerances_.rtol = mode_tolerances_.rtol * root_share_ * rooted_rtol_;
  tolerances_.atol = mode_tolerances_.atol * root_share_ * lap_share_ * rooted_atol_;
}

/// Behind a step: tolerances go with det G where that is small. The motion may run into a point (a folded node of the
/// sliding motion, as it does from an open set of states) with det G ~ T, the time that is left, and the discriminant
/// ~ T^2: an error e made there and then ends it sqrt(e) too early, one that was made T before by e / T. Solutions are
/// smooth in t there, so that steps may shrink in proportion to T: some thirty of them instead of hundreds whose stages
/// have no root.
void Run::follow_roots() {
  if (field_.solve() != SlidingSolve::coupled) return;
  constexpr double near = 0.1;
  // What doubles carry of a state, several hundred times.
  const double smallest = 1e-13 / mode_tolerances_.rtol;
  const double share = std::min(1.0, std::max(smallest, field_.root_distance(t_, x_.data()) / near));
  if (share == root_share_) return;
  root_share_ = share;
  set_tolerances();
}

}  // namespace saltus::event_integrator
