// From a solution of an interior-point method to one that is exact to rounding.
#pragma once

#include "saltus/solver/nlp_solver.hpp"

namespace saltus::solver::crossover {

/// Returns the largest of: violation of bounds and rows, gradient of the Lagrangian, min(multiplier, distance) of
/// inequalities.
[[nodiscard]] double optimality_error(mpcc::Problem& nlp, const NlpPoint& point);

/// Does Newton's method on the optimality conditions, with the bounds and inequalities held that the multipliers of the
/// point say are active. Steps solve a regularised system and are refined against the exact one, so that rows may
/// depend on each other. Changes the point only if its optimality_error falls; returns that of the point left. Cost: a
/// few sparse factorisations.
[[nodiscard]] double refine(mpcc::Problem& nlp, NlpPoint& point);

/// Finds rows that are equations and depend on others at v, to be left out where there are more equations than
/// variables. Cost: one sparse QR factorisation.
[[nodiscard]] std::vector<int> dependent_equations(mpcc::Problem& nlp, ConstVectorView v);

}  // namespace saltus::solver::crossover
