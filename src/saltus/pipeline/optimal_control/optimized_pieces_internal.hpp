// The elements of an optimised point with their active sets, one after the other.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "saltus/discretization/butcher_tableau.hpp"
#include "saltus/discretization/ocp/ocp_problem.hpp"
#include "saltus/discretization/point_functions.hpp"
#include "saltus/discretization/stage_kernel.hpp"
#include "saltus/fesd_integrator/element/active_set.hpp"
#include "saltus/fesd_integrator/element/element.hpp"
#include "saltus/fesd_integrator/element/facts.hpp"
#include "saltus/fesd_integrator/solution.hpp"

namespace saltus::pipeline {

/// Holds an element that has a length.
struct OptimizedPiece {
  fesd_integrator::Element element;
  double end = 0.0;  ///< its right end: where the next one begins
  fesd_integrator::ActiveSet set;
  std::vector<double> left, right;  ///< selections at its ends, limits from its inside
  std::vector<double> held;         ///< what is held in its interval
  bool is_frozen = false;           ///< time frozen by hand: the clock stands
};

/// Returns the left ends of the intervals in the time of the right-hand side, then the end of the last one.
[[nodiscard]] std::vector<double> node_times(double from, const discretization::OcpSolution& solution);

/// Leaves out elements that vanished (h < 1e-9 of the mean of their interval). Nothing is frozen yet.
[[nodiscard]] std::vector<OptimizedPiece> optimized_pieces(const discretization::OcpSolution& solution,
                                                           const std::vector<double>& times,
                                                           const discretization::StageKernel& kernel,
                                                           const discretization::PointFunctions& functions,
                                                           const fesd_integrator::Facts& facts);

/// Returns what is between the ends of pieces; the functions are for this only from now on.
[[nodiscard]] std::shared_ptr<fesd_integrator::Solution> solution_of(const std::vector<OptimizedPiece>& pieces,
                                                                     const discretization::ButcherTableau& tableau,
                                                                     discretization::StageKernel kernel,
                                                                     discretization::PointFunctions functions,
                                                                     const fesd_integrator::Facts& facts);

}  // namespace saltus::pipeline
