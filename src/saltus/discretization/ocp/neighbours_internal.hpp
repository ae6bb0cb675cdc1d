// Mode sequences beside that of a solved branch: the moves to them, and what the multipliers say of each.
#pragma once

#include <functional>
#include <set>
#include <vector>

#include "saltus/discretization/ocp/element_sides_internal.hpp"
#include "saltus/mpcc/multipliers.hpp"

namespace saltus::discretization {

using Moves = std::vector<mpcc::BranchMove>;

/// Holds a branch whose neighbours are looked for.
struct SolvedBranch {
  const OcpStructure& made;
  const ElementSides& modes;
  mpcc::ConstVectorView w;
  const mpcc::Multipliers* multipliers;  ///< null at a point beside the solution
};

/// Adds elements of length zero, where modes are that the motion can go on in: behind an element that ends on a
/// surface, with the modes of the next interval, or several up to the end of an impact; or what follows has them. Of
/// surfaces crossed at once an element between has the sides one by one.
/// @param crowded  intervals that have no element left for such a move are added
void add_insertions(const SolvedBranch& branch, std::set<int>& crowded, Moves& moves);

/// Adds those of them that begin where an element does.
void add_insertions_at(const SolvedBranch& branch, std::size_t element, std::set<int>& crowded, Moves& moves);

/// Adds moves that remove an element of length zero: it has the modes of a neighbour.
void add_removals(const SolvedBranch& branch, Moves& moves);

/// Adds moves that divide a stretch of equal modes whose lengths are at their bound into one element more.
void add_longer_stretches(const SolvedBranch& branch, Moves& moves);

/// Adds moves of what happens while time stands still at the end of an interval. It comes into the interval before,
/// with an element of what follows, or into the one behind, with an element of what was before.
void add_moved_standstills(const SolvedBranch& branch, Moves& moves);

/// Adds moves of surfaces that elements are held on although nothing depends on their selections there: either side of
/// them is the same point.
/// @param functions  rows of the problem at a point
void add_void_sides(const SolvedBranch& branch, const std::function<linalg::Vector(const linalg::Vector&)>& functions,
                    Moves& moves);

/// Adds moves to impacts where bodies only graze: behind one of velocity 0 nothing differs, so that they begin at a
/// point with other controls, where it has some.
void add_grazed_sides(const SolvedBranch& branch, std::set<int>& crowded, Moves& moves);

/// Adds moves of regions by indicators that a state comes to at the end of the horizon, or is held at until then: it
/// goes on through them, to the line between them and another one.
void add_reached_regions(const SolvedBranch& branch, Moves& moves);

/// Returns the price of other sides at the same point: the least multiplier of a side that may leave zero.
[[nodiscard]] double price_of_freed(const ElementSides::Sides& before, const ElementSides::Sides& after,
                                    const mpcc::Multipliers& multipliers);

}  // namespace saltus::discretization
