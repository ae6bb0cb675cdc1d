// Which z is taken where faces leave more than one open.
#pragma once

#include <vector>

#include "saltus/switching/point/held_rows.hpp"
#include "saltus/switching/point/point_problem.hpp"

namespace saltus::switching {

/// What y and z are relative to.
struct Sizes {
  double y, z;
};
[[nodiscard]] Sizes sizes_of(const PointProblem& problem, const PointSolution& solution);

/// Collects the equations of the faces of a solution.
void find_held_rows(const PointProblem& problem, const PointSolution& solution, HeldRows& rows);

/// Solves them: z, y and whether z is open; false where they contradict each other.
[[nodiscard]] bool solve_rows(const PointProblem& problem, HeldRows& rows, PointSolution& solution);

/// Takes of open z those with which the faces hold best, by the fewest blocks.
void choose_open(const PointProblem& problem, PointSolution& solution);

}  // namespace saltus::switching
