// All modes in which a solution can go on from several surfaces that influence each other: Filippov's non-uniqueness.
#pragma once

#include <vector>

#include "saltus/switching/table/group_decision.hpp"

namespace saltus::switching {

/// Holds a mode of all surfaces of a group with its selections, m each.
struct GroupMode {
  std::vector<int> mode;
  std::vector<double> alpha;
};

/// Largest group whose modes are looked for: 3^m of them.
inline constexpr int largest_enumerated = 4;

/// Says what becomes of modes of which an inequality is an equality, to 1e-10: the solution may move along a surface
/// that it is beside, or slide with a selection at its bound.
enum class Borderline {
  left_out,
  kept,  ///< and of modes that slide only those whose root some scaling makes stable
};

/// Returns the modes k that continue a solution in the sense of Definition 2.1 of [guglielmi2022], each by its own
/// inequalities:
///   g_j(alpha) = 0 with alpha_j in (0, 1) where k_j = 0, k_j g_j(alpha) > 0 elsewhere (regions: by the drifts),
/// whatever the stability of their roots.
///
/// Roots are found by bisection of the face on which the selections vary. On a box every g_j lies between its values at
/// the corners, so that boxes with a g_j of one sign hold none. From a box Newton's method may find a root. The box
/// holds no other if G(root)^-1 G has dominant diagonals at the corners of a box around both. None is missed but in
/// boxes of width 2^-9 that pass neither test: roots that are double, or nearly.
/// @param table  m <= largest_enumerated surfaces
/// Cost: half a millisecond for three surfaces, ten for four, once per meeting of so many. Allocates.
[[nodiscard]] std::vector<GroupMode> admissible_modes(const CornerTable& table,
                                                      Borderline borderline = Borderline::left_out);

}  // namespace saltus::switching
