// Whether a point has a direction of descent: the linear program over its linearised constraints.
#pragma once

#include <vector>

#include "saltus/solver/certificate/multipliers.hpp"
#include "saltus/solver/lpcc_solver.hpp"

namespace saltus::solver::certificate {

/// States min grad f'd over the linearised constraints, |d|_inf <= radius, in units of the radius; the open groups of
/// pairs as disjunctions, the sides of all other pairs as they are.
struct Linearisation {
  LpccProblem problem;
  double scale = 1.0;                    ///< max(1, |grad f|_inf)
  std::vector<std::vector<int>> groups;  ///< pairs of each disjunction
};

/// @param reduction  of the branch problem that w solves: what its closure holds or makes equal stays so; or null.
///                   LIMIT: other sides may have another closure, with more directions; flips see those, this does not
[[nodiscard]] Linearisation linearise(mpcc::Problem& problem, ConstVectorView w, const PairStates& states,
                                      const crossover::Reduction* reduction, double radius);

}  // namespace saltus::solver::certificate
