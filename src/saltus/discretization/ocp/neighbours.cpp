#include <algorithm>
#include <iterator>
#include <utility>

#include "saltus/discretization/ocp/element_trial_internal.hpp"
#include "saltus/discretization/ocp/neighbours_internal.hpp"
#include "saltus/discretization/ocp/ocp_problem_internal.hpp"
#include "saltus/discretization/ocp/surface_states_internal.hpp"

namespace saltus::discretization {
namespace {

using mpcc::ActiveSide;
using Modes = ElementSides::Sides;

/// The price of other sides at the same point: the least multiplier of a side that may leave zero, as far as it comes
/// from rest in the time of an inserted element.
double price_of_freed(const Modes& before, const Modes& after, const mpcc::Multipliers& multipliers) {
  double least = 0.0;
  for (std::size_t pair = 0; pair < before.size(); ++pair) {
    if (before[pair] == after[pair]) continue;
    const auto& of_side = before[pair] == ActiveSide::G ? multipliers.G : multipliers.H;
    least = std::min(least, of_side[static_cast<linalg::Index>(pair)]);
  }
  return inserted_share * inserted_share * least;
}

/// Finds elements that are on a surface throughout, and may be beside it.
class Flips {
 public:
  explicit Flips(const SolvedBranch& branch)
      : branch_(branch), states_(branch.made), trial_(branch.made, branch.w), elements_(branch.made.element.size()) {}

  void add_to(Moves& moves) const {
    for (std::size_t surface = 0; surface < states_.count(); ++surface) {
      const Sides below = sides(surface, -1), above = sides(surface, 1);
      for (std::size_t cut = 1; cut <= elements_; ++cut) {
        add_same(below, above, cut, moves);
        add_same(above, below, cut, moves);
      }
      add_leaving(below, moves);
      add_leaving(above, moves);
    }
  }

 private:
  /// What an element has on one side of a surface that it is held on.
  struct Side {
    Modes modes;
    bool is_same = false;    ///< the motion is the same
    bool may_leave = false;  ///< it is another one, which leaves the surface
  };
  using Sides = std::vector<Side>;

  [[nodiscard]] Sides sides(std::size_t surface, int state) const {
    Sides list(elements_);
    for (std::size_t e = 0; e < elements_; ++e) {
      // Multipliers of an element of length zero are not unique, and say nothing.
      if (trial_.length_of(e) <= vanished || !states_.is_held(e, surface, branch_.w)) continue;
      const auto left = trial_.left_of(e);
      const auto k = at(branch_.made.element[e].interval);
      const Modes modes = states_.with(branch_.modes.modes(e), surface, state);
      const auto own = trial_.solve(left, k, modes, trial_.length_of(e));
      const bool is_same = own && are_near(trial_.right_of(*own), trial_.right_of(trial_.own_of(e)));
      const auto begin = is_same ? std::nullopt : trial_.solve(left, k, modes, inserted_share);
      list[e] = {modes, is_same, begin && trial_.is_admissible(*begin)};
    }
    return list;
  }

  /// One of these before the cut, the other one behind it, if there is any.
  void add_same(const Sides& before, const Sides& behind, std::size_t cut, Moves& moves) const {
    std::size_t first = cut, end = cut;
    while (first > 0 && before[first - 1].is_same) --first;
    while (end < elements_ && behind[end].is_same) ++end;
    const bool is_whole = cut == elements_ || !before[cut].is_same;
    if (first == cut || (end == cut && !is_whole)) return;
    Sides changed(elements_);
    for (std::size_t e = first; e < end; ++e) changed[e] = e < cut ? before[e] : behind[e];
    add(changed, moves);
  }

  /// Stretches of an interval one by one: multipliers say whether they should leave.
  void add_leaving(const Sides& side, Moves& moves) const {
    for (std::size_t first = 0, end = 0; first < elements_; first = end) {
      end = end_of_stretch(first);
      Sides changed(elements_);
      bool is_held = true;
      for (std::size_t e = first; e < end; ++e) {
        is_held = is_held && !side[e].modes.empty();
        changed[e] = side[e];
      }
      if (side[first].may_leave && is_held) add(changed, moves);
    }
  }

  [[nodiscard]] std::size_t end_of_stretch(std::size_t e) const {
    const auto& elements = branch_.made.element;
    do ++e;
    while (e < elements_ && elements[e].number > 0 && branch_.modes.are_equal(e - 1, e));
    return e;
  }

  void add(const Sides& changed, Moves& moves) const {
    ModeSequence sequence;
    for (std::size_t e = 0; e < elements_; ++e) {
      if (!changed[e].modes.empty()) sequence.try_emplace(at(branch_.made.element[e].interval));
    }
    for (std::size_t e = 0; e < elements_; ++e) {
      const auto interval = sequence.find(at(branch_.made.element[e].interval));
      if (interval == sequence.end()) continue;
      Stretch stretch = branch_.stretches(e, e + 1).front();
      if (!changed[e].modes.empty()) stretch.modes = changed[e].modes;
      interval->second.push_back(std::move(stretch));
    }
    const auto count = moves.size();
    add_move(branch_, sequence, "flip", std::nullopt, moves);
    if (moves.size() == count) return;
    moves.back().price = price_of_freed(branch_.modes.all(), moves.back().sides, branch_.multipliers);
  }

  const SolvedBranch& branch_;
  SurfaceStates states_;
  ElementTrial trial_;
  std::size_t elements_;
};

/// What lengths beyond the bound are worth: the multipliers of equal lengths stand at one of them.
double price_of_bound(const SolvedBranch& branch, std::size_t k) {
  double price = 0.0;
  for (const int h : branch.made.interval[k].lengths) price = std::min(price, -branch.multipliers.upper[h]);
  return inserted_share * price;
}

}  // namespace

bool add_move(const SolvedBranch& branch, const ModeSequence& sequence, const char* name, std::optional<double> price,
              Moves& moves) {
  const auto& [made, modes, w, multipliers] = branch;
  auto realised = realise(made, modes, w, sequence);
  if (!realised) return false;
  mpcc::BranchMove move{
      .sides = std::move(realised->sides), .start = std::move(realised->w), .price = price, .name = name};
  const ElementSides changed(made, move.sides);
  for (std::size_t e = 0; e < made.element.size(); ++e) {
    const int h = made.element[e].length;
    if (h >= 0 && move.start[h] > vanished && changed.modes(e) != modes.modes(e)) move.appearing.push_back(h);
  }
  moves.push_back(std::move(move));
  return realised->has_room;
}

/// Equations of an element of length zero depend on each other: more than one multiplier serves, and none says a price.
void add_removals(const SolvedBranch& branch, Moves& moves) {
  for (std::size_t k = 0; k < branch.made.interval.size(); ++k) {
    const Stretches stretches = branch.stretches(k);
    for (std::size_t i = 0; i < stretches.size() && stretches.size() > 1; ++i) {
      if (!stretches[i].has_vanished()) continue;
      const bool is_between = i > 0 && i + 1 < stretches.size() && stretches[i - 1].modes == stretches[i + 1].modes;
      for (const auto neighbour : {i - 1, i + 1}) {
        if (neighbour >= stretches.size() || (is_between && neighbour > i)) continue;
        Stretches fewer = stretches;
        fewer[neighbour].elements += fewer[i].elements;
        fewer.erase(fewer.begin() + static_cast<std::ptrdiff_t>(i));
        auto realised = realise(branch.made, branch.modes, branch.w, {{k, std::move(fewer)}});
        if (!realised) continue;
        moves.push_back({.sides = std::move(realised->sides),
                         .start = std::move(realised->w),
                         .name = "removal",
                         .is_simpler = true});
      }
    }
  }
}

void add_splits(const SolvedBranch& branch, Moves& moves) {
  for (std::size_t k = 0; k < branch.made.interval.size(); ++k) {
    const auto& lengths = branch.made.interval[k].lengths;
    const Stretches stretches = branch.stretches(k);
    for (std::size_t i = 0; i < stretches.size() && !lengths.empty(); ++i) {
      const int h = branch.made.element[stretches[i].origin].length;
      if (branch.w[h] < branch.made.w_bounds.upper[h] - vanished) continue;
      for (const auto neighbour : {i - 1, i + 1}) {
        if (neighbour >= stretches.size() || stretches[neighbour].elements == 1) continue;
        Stretches longer = stretches;
        ++longer[i].elements;
        --longer[neighbour].elements;
        add_move(branch, {{k, std::move(longer)}}, "split", price_of_bound(branch, k), moves);
      }
    }
  }
}

void add_flips(const SolvedBranch& branch, Moves& moves) { Flips(branch).add_to(moves); }

std::vector<mpcc::BranchMove> OcpProblem::neighbours(const std::vector<ActiveSide>& sides, mpcc::ConstVectorView w,
                                                     const mpcc::Multipliers& multipliers) {
  const auto& made = *implementation_->structure;
  Moves moves;
  if (!made.kernel.moves || made.kernel.pairs.empty()) return moves;
  const ElementSides modes(made, sides);
  const SolvedBranch branch{made, modes, w, multipliers};
  implementation_->crowded.clear();
  add_splits(branch, moves);
  add_removals(branch, moves);
  add_insertions(branch, implementation_->crowded, moves);
  add_flips(branch, moves);
  return moves;
}

}  // namespace saltus::discretization
