// An optimised point as what a run of elements leaves.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "saltus/base/error.hpp"
#include "saltus/discretization/butcher_tableau.hpp"
#include "saltus/fesd_integrator/solution.hpp"
#include "saltus/result/result.hpp"

namespace saltus::model {
struct System;
}
namespace saltus::reformulation {
struct Dcs;
}
namespace saltus::discretization {
struct OcpSolution;
}

namespace saltus::fesd_integrator {

/// Of the horizon: a clock that gains less in an element stands.
inline constexpr double standing_clock = 1e-9;

/// Says which state is physical time.
struct OptimumClock {
  std::size_t state = 0;
  bool by_hand = false;  ///< the user's; else the system was frozen for its contacts and hysteresis
};

struct OptimumRun {
  result::Trajectory trajectory;
  result::Events events;
  result::Final final;
  result::Elements elements;           ///< with a clock at its times
  result::Events events_of_all;        ///< in the time of the right-hand side, with those of frozen pieces
  std::shared_ptr<Solution> solution;  ///< null with a clock
};

/// Reads the sides of the pairs of an element off its sums over the stages: the smaller one is zero. Rows are at stages
/// and ends of elements, events where the active set changes; elements have the complementarities at their points.
/// @param system  with the parameters, the initial state and the controls of the solution
/// @param times   left ends of the intervals in the time of the right-hand side, then the end of the last one
/// @param clock   frozen by hand, rows and events are at its times and those of frozen pieces are left out; else all of
///                them are there, in the time of the others
[[nodiscard]] Expected<OptimumRun> optimum_run(const model::System& system, const reformulation::Dcs& dcs,
                                               const discretization::OcpSolution& solution,
                                               const std::vector<double>& times,
                                               const discretization::ButcherTableau& tableau,
                                               const std::optional<OptimumClock>& clock);

}  // namespace saltus::fesd_integrator
