#include <algorithm>
#include <utility>

#include "saltus/discretization/ocp/neighbours_internal.hpp"
#include "saltus/discretization/ocp/ocp_problem_internal.hpp"

namespace saltus::discretization {
namespace {

using mpcc::ActiveSide;

/// The point with another share of the interval for one element; the others keep their ratios.
linalg::Vector with_share(const OcpStructure& made, mpcc::ConstVectorView w, const OcpElement& element, double share) {
  linalg::Vector changed = w;
  const auto& lengths = made.interval[at(element.interval)].lengths;
  const double rest = 1.0 - w[element.length];
  for (const int h : lengths) {
    if (h == element.length) {
      changed[h] = share;
    } else {
      changed[h] =
          rest > vanished ? w[h] * (1.0 - share) / rest : (1.0 - share) / static_cast<double>(lengths.size() - 1);
    }
  }
  return changed;
}

/// Lengths of the elements that have other modes than before.
void note_appearing(const OcpStructure& made, const ElementSides& modes, mpcc::BranchMove& move) {
  const ElementSides changed(made, move.sides);
  for (std::size_t e = 0; e < made.element.size(); ++e) {
    const int h = made.element[e].length;
    if (h >= 0 && move.start[h] > vanished && changed.modes(e) != modes.modes(e)) move.appearing.push_back(h);
  }
}

/// Removes elements of length zero on either side of the control node before element e: the motion before it goes on in
/// the interval behind it, or that behind it begins in the one before.
class NodeRemovals {
 public:
  NodeRemovals(const SolvedBranch& branch, std::size_t e) : branch_(branch), node_(e), before_(e - 1), after_(e) {
    const auto& elements = branch.made.element;
    while (elements[before_].number > 0 && is_empty(before_)) --before_;
    while (after_ + 1 < elements.size() && elements[after_ + 1].number > 0 && is_empty(after_)) ++after_;
  }
  void add_to(Moves& moves) const {
    const bool has_empty = before_ + 1 < node_ || after_ > node_;
    if (!has_empty || branch_.modes.are_equal(before_, after_)) return;
    add(before_, before_ + 1, node_, node_, moves);
    add(after_, node_ - 1, after_ - 1, node_ - 1, moves);
  }

 private:
  [[nodiscard]] bool is_empty(std::size_t e) const {
    const int h = branch_.made.element[e].length;
    return h >= 0 && branch_.w[h] < vanished;
  }
  /// Gives the modes of element `from` to others, of which the last named grows, unless it may not be short.
  void add(std::size_t from, std::size_t first, std::size_t last, std::size_t grows, Moves& moves) const {
    const auto& [made, modes, w, multipliers] = branch_;
    const auto& element = made.element[grows];
    if (element.length < 0 || made.w_bounds.lower[element.length] > small_share) return;
    mpcc::BranchMove move{modes.all(), with_share(made, w, element, small_share)};
    for (std::size_t e = first; e <= last; ++e) modes.copy(from, e, move.sides);
    moves.push_back(std::move(move));
  }

  const SolvedBranch& branch_;
  std::size_t node_, before_, after_;
};

}  // namespace

double price_of_freed(const ElementSides::Sides& before, const ElementSides::Sides& after,
                      const mpcc::Multipliers& multipliers) {
  double least = 0.0;
  for (std::size_t pair = 0; pair < before.size(); ++pair) {
    if (before[pair] == after[pair]) continue;
    const auto& of_side = before[pair] == ActiveSide::G ? multipliers.G : multipliers.H;
    least = std::min(least, of_side[static_cast<linalg::Index>(pair)]);
  }
  return least;
}

void add_removals(const SolvedBranch& branch, Moves& moves) {
  const auto& [made, modes, w, multipliers] = branch;
  // Equations of an element of length zero depend on each other: more than one multiplier serves, and none says a
  // price.
  const auto add = [&](std::size_t from, std::size_t to) {
    const int h = made.element[to].length;
    if (h < 0 || w[h] >= vanished) return;
    moves.push_back({modes.copied(from, to), w});
  };
  for (std::size_t e = 1; e < made.element.size(); ++e) {
    if (made.element[e].number == 0) NodeRemovals(branch, e).add_to(moves);
    if (made.element[e].number == 0 || modes.are_equal(e - 1, e)) continue;
    add(e - 1, e);
    add(e, e - 1);
  }
}

std::vector<mpcc::BranchMove> OcpProblem::neighbours(const std::vector<ActiveSide>& sides, mpcc::ConstVectorView w,
                                                     const mpcc::Multipliers& multipliers) {
  const auto& made = *implementation_->structure;
  Moves moves;
  if (!made.kernel.moves || made.kernel.pairs.empty()) return moves;
  const ElementSides modes(made, sides);
  const SolvedBranch branch{made, modes, w, &multipliers};
  auto& crowded = implementation_->crowded;
  crowded.clear();
  const auto functions = [&](const linalg::Vector& point) {
    linalg::Vector c(rows());
    implementation_->functions(point, c);
    return c;
  };
  add_longer_stretches(branch, moves);
  add_removals(branch, moves);
  add_insertions(branch, crowded, moves);
  add_moved_standstills(branch, moves);
  add_void_sides(branch, functions, moves);
  add_grazed_sides(branch, crowded, moves);
  add_reached_regions(branch, moves);
  for (auto& move : moves) note_appearing(made, modes, move);
  return moves;
}

}  // namespace saltus::discretization
