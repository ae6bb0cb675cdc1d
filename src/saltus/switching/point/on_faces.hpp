// The solution of a problem of complementarity on given faces.
#pragma once

#include <vector>

#include "saltus/base/function_ref.hpp"
#include "saltus/switching/point/held_rows.hpp"
#include "saltus/switching/point/point_problem.hpp"

namespace saltus::switching {

/// Finds z and y on given faces; absent blocks are open. False where the faces contradict each other.
/// Where z is open it is where the faces hold best, by few blocks. Cost: an elimination; where z is open, one for each
/// block that is left idle, and for each of them a least-squares problem with signs.
[[nodiscard]] bool solve_on(const PointProblem& problem, const std::vector<Face>& faces, PointSolution& solution);

/// Finds the least z on given faces, and y; where z is open it is not yet where they hold best.
/// @param rows  memory
[[nodiscard]] bool solve_least(const PointProblem& problem, const std::vector<Face>& faces, HeldRows& rows,
                               PointSolution& solution);

/// Solves anew with other blocks idle; returns whether the faces still hold.
[[nodiscard]] bool solve_without(const PointProblem& problem, const std::vector<int>& idle, PointSolution& solution);

/// Returns the changes of z, as columns, that the faces of a solution leave open, those of idle blocks among them.
[[nodiscard]] linalg::Matrix open_changes(const PointProblem& problem, const PointSolution& solution);

/// Returns whether y is the same for all z that the faces of a solution leave open.
[[nodiscard]] bool is_determined(const PointProblem& problem, const PointSolution& solution);

/// Returns the margin of a solution.
[[nodiscard]] double margin_of(const PointProblem& problem, const PointSolution& solution);

/// Finds the directions in which blocks begin to slip from rest: along the rates of their tangential velocities, which
/// follow from the directions.
/// @param free        blocks that begin to slip, of two tangents each
/// @param directions  by block, unit vectors: those of `free` are found, from what they are
/// @param solve       finds z and y for the directions; returns false where there are none
/// @return false where solve does, or nothing is found
[[nodiscard]] bool find_directions(const PointProblem& problem, const std::vector<int>& free,
                                   std::vector<linalg::Vector>& directions, const linalg::Vector& z,
                                   const linalg::Vector& y, FunctionRef<bool()> solve);

}  // namespace saltus::switching
