// Mode sequences beside that of a solved branch: the moves to them, and what the multipliers say of each.
#pragma once

#include <optional>
#include <set>
#include <vector>

#include "saltus/discretization/ocp/mode_sequence_internal.hpp"
#include "saltus/mpcc/multipliers.hpp"

namespace saltus::discretization {

using Moves = std::vector<mpcc::BranchMove>;

/// The share of an interval that an element gets whose price is known: it may not make the objective so much worse that
/// the branch is given up.
inline constexpr double inserted_share = 0.1 * small_share;

/// Holds a branch whose neighbours are looked for.
struct SolvedBranch {
  const OcpStructure& made;
  const ElementSides& modes;
  mpcc::ConstVectorView w;
  const mpcc::Multipliers& multipliers;

  /// Returns the stretches of elements of one interval.
  [[nodiscard]] Stretches stretches(std::size_t first, std::size_t end) const {
    return stretches_of(made, modes, w, first, end);
  }
  [[nodiscard]] Stretches stretches(std::size_t k) const {
    const auto first = at(made.interval[k].first_element);
    return stretches(first, first + at(made.interval[k].elements));
  }
};

/// Adds the move to a sequence.
/// @return whether its intervals have elements for it
bool add_move(const SolvedBranch& branch, const ModeSequence& sequence, const char* name, std::optional<double> price,
              Moves& moves);

/// Inserts elements at boundaries, in modes that meet there: one, or those of an impact and what is behind it; also
/// those of which one surface is crossed before others that are crossed at the same time. Over a control node it
/// inserts, before it or behind it, what is on the other side, with the impact that happens there: it shifts the
/// switch.
/// @param crowded  intervals that have no element left for such a move are added
void add_insertions(const SolvedBranch& branch, std::set<int>& crowded, Moves& moves);

/// Gives elements of length zero to a neighbour.
void add_removals(const SolvedBranch& branch, Moves& moves);

/// Gives stretches whose elements are as long as they may be one of another stretch.
void add_splits(const SolvedBranch& branch, Moves& moves);

/// Gives elements that are held on a surface either side of it, where that is the same motion: a selection is at its
/// bound, or nothing depends on it. Several may be on one side up to a boundary, and on the other one behind.
void add_flips(const SolvedBranch& branch, Moves& moves);

}  // namespace saltus::discretization
