// The elements of an optimised point with their active sets, one after the other.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "saltus/discretization/butcher_tableau.hpp"
#include "saltus/discretization/point_functions.hpp"
#include "saltus/discretization/stage_kernel.hpp"
#include "saltus/fesd_integrator/element/active_set.hpp"
#include "saltus/fesd_integrator/element/element.hpp"
#include "saltus/fesd_integrator/element/facts.hpp"
#include "saltus/fesd_integrator/solution.hpp"

namespace saltus::discretization {
struct OcpSolution;
}

namespace saltus::fesd_integrator {

/// Holds an element that has a length.
struct OptimizedPiece {
  Element element;
  double end = 0.0;  ///< its right end: where the next one begins
  ActiveSet set;
  std::vector<double> left, right;  ///< selections at its ends, limits from its inside
  std::vector<double> held;         ///< what is held in its interval
  bool is_frozen = false;           ///< time frozen by hand: the clock stands
};

/// Returns the elements of the point, whose intervals have these left ends and the end of the last one. Leaves out
/// elements that vanished (h < 1e-9 of the mean of their interval). Nothing is frozen yet.
[[nodiscard]] std::vector<OptimizedPiece> optimized_pieces(const discretization::OcpSolution& solution,
                                                           const std::vector<double>& times,
                                                           const discretization::StageKernel& kernel,
                                                           const discretization::PointFunctions& functions,
                                                           const Facts& facts);

/// Returns what is between the ends of pieces; the functions are for this only from now on.
[[nodiscard]] std::shared_ptr<Solution> solution_of(const std::vector<OptimizedPiece>& pieces,
                                                    const discretization::ButcherTableau& tableau,
                                                    discretization::StageKernel kernel,
                                                    discretization::PointFunctions functions, const Facts& facts);

}  // namespace saltus::fesd_integrator
