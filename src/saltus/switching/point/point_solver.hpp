// The solutions of a problem of complementarity at a point.
#pragma once

#include <optional>
#include <vector>

#include "saltus/switching/point/faces_by_pivots.hpp"
#include "saltus/switching/point/on_faces.hpp"
#include "saltus/switching/point/point_problem.hpp"

namespace saltus::switching {

struct PointSolutions {
  std::vector<PointSolution> all;  ///< those with most contact first
  bool complete = false;           ///< there are no others
};

/// What the caller knows of the faces.
struct FaceHints {
  /// By block: faces that are known to end here. Blocks that are open have no say.
  std::vector<std::vector<Face>> excluded = {};
  std::vector<Face> before = {};  ///< by block: faces that have held up to here; empty: none
  double holds = face_holds;      ///< the least margin of a solution
};

/// Finds the solutions of y = w + W z by the faces of the blocks: all of them, by a search over their combinations,
/// where these are no more than 2^12, and fewer where many leave z open; else some, by complementary pivots and from
/// the faces before. Cost: an elimination a combination; beyond, of n rows, 3 n pivots of 9 n^2 operations.
[[nodiscard]] PointSolutions solve_point(const PointProblem& problem, const FaceHints& hints);

/// Returns whether another solution has the same y and the same faces, but for closed blocks that it leaves open.
[[nodiscard]] bool is_same_with_open(const PointProblem& problem, const PointSolution& solution,
                                     const PointSolution& other);

/// Returns the margin of a solution but for its open blocks, which may touch without a force.
[[nodiscard]] double margin_of_forces(const PointProblem& problem, PointSolution solution);

/// Returns whether all solutions that were found have one y, whatever z is taken of those that the chosen one leaves
/// open; nothing where others may have been missed.
[[nodiscard]] std::optional<bool> is_one_motion(const PointProblem& problem, const PointSolutions& solutions,
                                                std::size_t chosen);

}  // namespace saltus::switching
