#include <algorithm>
#include <iterator>

#include "saltus/discretization/ocp/element_items_internal.hpp"
#include "saltus/discretization/ocp/neighbours_internal.hpp"

namespace saltus::discretization {
namespace {

using mpcc::ConstVectorView;

class MovedStandstills {
 public:
  MovedStandstills(const OcpStructure& made, const ElementSides& modes, ConstVectorView w)
      : made_(made), items_(made, modes, w) {}

  void add_to(std::vector<mpcc::BranchMove>& moves) const {
    for (std::size_t k = 0; k + 1 < made_.interval.size(); ++k) add_at_end_of(k, moves);
    for (std::size_t k = 0; k < made_.interval.size(); ++k) add_within(k, moves);
  }

 private:
  /// What is before it, and behind it, and itself, of the elements of intervals k and k + 1.
  void add_at_end_of(std::size_t k, std::vector<mpcc::BranchMove>& moves) const {
    const Items left = items_.of_interval(k), right = items_.of_interval(k + 1);
    const auto stands = [&](const Item& item) { return items_.stands_still(item.element); };
    const auto begin = std::find_if_not(left.rbegin(), left.rend(), stands).base();
    const auto end = std::find_if_not(right.begin(), right.end(), stands);
    Items before(left.begin(), begin), still(begin, left.end()), after(end, right.end());
    still.insert(still.end(), right.begin(), end);
    if (ElementItems::length_of(still) <= vanished || before.empty() || after.empty()) return;
    add(k, before, still, after, moves);
    if (still.size() < 2) return;
    // Modes that differ may say the same: there is room for one where there is none for all.
    const auto longest = std::max_element(still.begin(), still.end(), is_shorter);
    add(k, before, {{longest->element, ElementItems::length_of(still), longest->modes}}, after, moves);
  }

  /// From inside an interval to its end, where the element on the other side is as long as it may be.
  void add_within(std::size_t k, std::vector<mpcc::BranchMove>& moves) const {
    const Items items = items_.of_interval(k);
    const auto stands = [&](const Item& item) { return items_.stands_still(item.element); };
    const auto begin = std::find_if(items.begin(), items.end(), stands);
    const auto end = std::find_if_not(begin, items.end(), stands);
    if (begin == items.begin() || end == items.end()) return;
    Items to_left(begin, items.end()), to_right(items.begin(), end);
    to_left.back().length += ElementItems::length_of({items.begin(), begin});
    to_right.front().length += ElementItems::length_of({end, items.end()});
    if (items_.is_at_bound(*end)) items_.add({{k, to_left}}, moves);
    if (items_.is_at_bound(*std::prev(begin))) items_.add({{k, to_right}}, moves);
  }

  void add(std::size_t k, const Items& before, const Items& still, const Items& after,
           std::vector<mpcc::BranchMove>& moves) const {
    const auto joined = [](Items items, const Items& more, const Items& rest) {
      items.insert(items.end(), more.begin(), more.end());
      items.insert(items.end(), rest.begin(), rest.end());
      return items;
    };
    items_.add(
        {{k, joined(before, still, {{after.front().element, small_share, after.front().modes}})}, {k + 1, after}},
        moves);
    items_.add(
        {{k, before}, {k + 1, joined({{before.back().element, small_share, before.back().modes}}, still, after)}},
        moves);
  }

  [[nodiscard]] static bool is_shorter(const Item& a, const Item& b) { return a.length < b.length; }
  const OcpStructure& made_;
  ElementItems items_;
};

}  // namespace

void add_moved_standstills(const SolvedBranch& branch, Moves& moves) {
  if (branch.made.kernel.clock >= 0) MovedStandstills(branch.made, branch.modes, branch.w).add_to(moves);
}

}  // namespace saltus::discretization
