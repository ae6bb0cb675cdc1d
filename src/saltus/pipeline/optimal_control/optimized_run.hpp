// The trajectory of an optimised point in the columns of a result.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "saltus/base/error.hpp"
#include "saltus/discretization/butcher_tableau.hpp"
#include "saltus/discretization/ocp/ocp_problem.hpp"
#include "saltus/mpcc/problem.hpp"
#include "saltus/pipeline/optimal_control/verify.hpp"
#include "saltus/reformulation/reformulation_options.hpp"
#include "saltus/result/result.hpp"

namespace saltus::model {
struct Ocp;
}

namespace saltus::pipeline {

/// Holds what a simulation with `fesd` has, too:
/// - rows at stages and ends of elements with controls of the user and shown_outputs();
/// - events where the active set changes;
/// - the complementarities at the points of the elements.
struct OptimizedRun {
  result::Trajectory trajectory;
  result::Events events;
  result::Final final;
  result::Elements elements;
  /// The same for the truth check: nodes, controls, ranges, events in the time of the right-hand side.
  OptimizedPath path;
  std::shared_ptr<result::Continuous> continuous;  ///< null where time is frozen
  std::vector<std::string> switching_functions;    ///< of a frozen system: those that the result shows
};

/// Returns which outputs of the system a result shows: all but those of the problem and the rate of a hidden clock.
[[nodiscard]] std::vector<std::size_t> shown_outputs(const model::Ocp& ocp);

/// Reads the sides of the pairs of an element off its sums over the stages: the smaller one is zero. Where time is
/// frozen by hand, rows, events and elements of the result are in physical time (the clock), frozen pieces left out of
/// trajectory and events; those of `path` are in the time of the right-hand side.
[[nodiscard]] Expected<OptimizedRun> optimized_run(const model::Ocp& ocp, const discretization::OcpSolution& solution,
                                                   const reformulation::ReformulationOptions& form,
                                                   const discretization::ButcherTableau& tableau);

}  // namespace saltus::pipeline
