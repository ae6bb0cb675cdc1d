// What happens where two surfaces that influence each other intersect: the decision trees of [guglielmi2022], Figs.
// 5-10.
//
// Everything is decided by the hidden dynamics u_j' = kappa_j g_j(pi(u)) of the point, in closed form, for all scalings
// kappa at once. Which function to ask, and what it needs beside the table of normal components at the point:
//   sliding on one surface reaches the other         decide_entering        the mode before
//   a selection leaves the square, exit (a)          decide_exit_edge       through which edge
//   both selections leave together                   decide_exit_corner     through which corner
//   the two roots coalesce and vanish, exit (b)      decide_exit_fold       -
//   min(G11, G22) becomes 0, exit (c)                decide_exit_unstable   -
//   a classical solution reaches both at once        decide_corner_arrival  the region it comes from
//   a solution starts on the intersection            decide_intersection_start
//   a spiral shrinks to the point                    decide_spiral_in; times and places by spiral.hpp
// While sliding on, the selections are intersection_roots(table).rising. Where the roots meet and part again (the first
// case of exit (c)) nothing is to be decided.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>

#include "saltus/switching/plane/admissible_modes.hpp"
#include "saltus/switching/plane/plane_table.hpp"
#include "saltus/switching/selection_policy.hpp"

namespace saltus::switching {

/// Names the leaves of the trees; docs/switching-trees.md draws them.
enum class Leaf {
  none,
  // clang-format off
  E1, E2, E3, E4, E5, E6, E7, E8, E9, E10, E11, E12,   // entering, Figs. 5 and 6
  A1, A2, A3,                                          // exit (a), Fig. 7
  UU1, UU2, UD1, UD2, UD3, DD1, DD2, DU,               // exit (b), Fig. 8
  C9_1, C9_2, C9_3, C9_4, C10_1, C10_2, C10_3, C10_4,  // exit (c), Figs. 9 and 10
  K1, K2, K3,                                          // exit through a corner of the square
  P1, P2,                                              // a region is left through the intersection
  S1, S2, S3,                                          // start
  spiral_in, spiral_out,                               // (4.14)
  // clang-format on
};
/// Returns the name of a leaf: "E1", "C9-2".
[[nodiscard]] std::string_view name(Leaf leaf);

struct PlaneDecision {
  Leaf leaf = Leaf::none;
  std::string_view reason;  ///< the leaf in words; of static duration
  /// Empty if decided. Else the quantity whose sign is below rounding (1e-10 of its scale) or that the trees do not
  /// know: what is chosen is a guess, ask the hidden dynamics.
  std::string_view undecided;
  PlaneContinuation chosen;
  PlaneModes others;  ///< all other admissible modes; empty = unique in the sense of Definition 2.1
  /// The regularised solutions have more than one limit: by the scaling kappa (`by_scaling`), or by a perturbation.
  bool ambiguous = false;
  bool by_scaling = false;
  bool spirals_out = false;  ///< `chosen` is the first region of a spiral, one of a family (spiral.hpp)

  [[nodiscard]] bool unique() const { return others.size() == 0 && !spirals_out; }
};

/// Decides the usual passage of a solution that slides on one surface across the other: on both sides the first one
/// attracts, and all four fields lead across. The mode behind is the only one, leaf E3 of decide_entering(), whose
/// answer this is; nullopt where it is not so, or not clear of any rounding. Cost: O(1), the tree is not gone through.
/// @param incoming  0 for the surface that is slid on, the side it comes from for the other
[[nodiscard]] std::optional<PlaneContinuation> pass_across(const PlaneTable& table, PlaneMode incoming);
/// Returns why; the text has static duration.
[[nodiscard]] std::string_view reason_of_passage();

/// Decides where sliding on one surface arrives at the other (Figs. 5 and 6 of [guglielmi2022]).
/// @param incoming  0 for the surface that is slid on, the side it comes from for the other
[[nodiscard]] PlaneDecision decide_entering(const PlaneTable& table, PlaneMode incoming,
                                            SelectionPolicy policy = SelectionPolicy::active_dominant);

/// Says that the selection of `surface` passes 0 (side = -1) or 1 (side = +1) on its way out, the other is inside: exit
/// (a), Fig. 7.
struct SquareEdge {
  std::size_t surface = 0;
  int side = 1;
};
[[nodiscard]] PlaneDecision decide_exit_edge(const PlaneTable& table, SquareEdge edge);

/// Decides where both selections leave the square together, through `corner` (two signs). The drifts of the field of
/// that corner must be those of second order: its normal components are 0 there. Extends Fig. 7 where the linearised
/// hidden dynamics at the corner has one outcome for all scalings; else undecided.
[[nodiscard]] PlaneDecision decide_exit_corner(const PlaneTable& table, PlaneMode corner);

/// Decides where the two roots coalesce inside the square and vanish: exit (b), Fig. 8.
[[nodiscard]] PlaneDecision decide_exit_fold(const PlaneTable& table);

/// Decides where min(G11, G22) of the root becomes 0 while the other is positive: exit (c), Figs. 9 and 10. The table
/// is taken at that point or shortly behind. Never unique: staying on the root is a solution.
[[nodiscard]] PlaneDecision decide_exit_unstable(const PlaneTable& table);

/// Decides where a solution in the region `incoming` (two signs) reaches both surfaces at once, as happens with
/// symmetric systems. It is decided where reaching either surface first leads to the same mode; else undecided.
[[nodiscard]] PlaneDecision decide_corner_arrival(const PlaneTable& table, PlaneMode incoming);

/// Decides where a solution starts on the intersection: the only admissible mode; else the only one that attracts; else
/// one of those with most sliding, psi > 0 rather than psi < 0 (and the first surface before the second). Where the
/// fields turn around an unstable root, the spiral.
[[nodiscard]] PlaneDecision decide_intersection_start(const PlaneTable& table);

/// Decides where the fields turn around the intersection with gamma < 1 (section 4.4 of [guglielmi2022]): sliding on
/// it. The root has (4.12) then, and is the only continuation.
[[nodiscard]] PlaneDecision decide_spiral_in(const PlaneTable& table);

}  // namespace saltus::switching
