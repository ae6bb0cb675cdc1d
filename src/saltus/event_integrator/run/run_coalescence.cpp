// Sliding on several surfaces towards a point at which its root meets another one.
#include <algorithm>

#include "saltus/event_integrator/run/run_internal.hpp"

namespace saltus::event_integrator {

/// Behind a step: tolerances go with det G where that is small. The motion may run into a point (a folded node of the
/// sliding motion, as it does from an open set of states) with det G ~ T, the time that is left, and the discriminant
/// ~ T^2: an error e made there and then ends it sqrt(e) too early, one that was made T before by e / T. Solutions are
/// smooth in t there, so that steps may shrink in proportion to T: some thirty of them instead of hundreds whose stages
/// have no root.
void Run::limit_beside_coalescence() {
  if (run_.field.solve() != SlidingSolve::coupled) return;
  constexpr double near = 0.1;
  const double share = std::min(
      1.0, std::max(run_.tolerances.smallest_part(), run_.field.root_distance(run_.here.t, run_.here.x.data()) / near));
  run_.tolerances.limit(StepTolerances::Reason::coalescence, {share, share});
}

/// Before a step of length h: errors of functions that the field has roots of.
void Run::limit_beside_zeros(double h) {
  const auto cycle = switches_.cycle();
  if (!zeros_.any_continued() && !nested_.watches() && !(cycle && zeros_.any_ending())) return;
  ode::Tolerances parts = zeros_.bearable(h, cycle, run_.tolerances.mode());
  nested_.limit(parts);
  run_.tolerances.limit(StepTolerances::Reason::zeros, parts);
}

}  // namespace saltus::event_integrator
