#include <algorithm>
#include <iterator>
#include <utility>

#include "saltus/discretization/ocp/element_sides_internal.hpp"

namespace saltus::discretization {
namespace {

using mpcc::ConstVectorView;

/// An element whose modes and variables another one takes, with its length in parts of a control interval's.
struct Item {
  std::size_t element = 0;
  double length = 0.0;
};
using Items = std::vector<Item>;

class MovedStandstills {
 public:
  MovedStandstills(const OcpStructure& made, const ElementSides& modes, ConstVectorView w)
      : made_(made), modes_(modes), w_(w) {}

  void add_to(std::vector<mpcc::BranchMove>& moves) const {
    for (std::size_t k = 0; k + 1 < made_.interval.size(); ++k) add_at_end_of(k, moves);
    for (std::size_t k = 0; k < made_.interval.size(); ++k) add_within(k, moves);
  }

 private:
  /// What is before it, and behind it, and itself, of the elements of intervals k and k + 1.
  void add_at_end_of(std::size_t k, std::vector<mpcc::BranchMove>& moves) const {
    const Items left = items_of(k), right = items_of(k + 1);
    const auto stands = [&](const Item& item) { return stands_still(item.element); };
    const auto begin = std::find_if_not(left.rbegin(), left.rend(), stands).base();
    const auto end = std::find_if_not(right.begin(), right.end(), stands);
    Items before(left.begin(), begin), still(begin, left.end()), after(end, right.end());
    still.insert(still.end(), right.begin(), end);
    if (length_of(still) <= vanished || before.empty() || after.empty()) return;
    add(k, before, still, after, moves);
    if (still.size() < 2) return;
    // Modes that differ may say the same: there is room for one where there is none for all.
    const auto longest = std::max_element(still.begin(), still.end(), is_shorter);
    add(k, before, {{longest->element, length_of(still)}}, after, moves);
  }

  /// From inside an interval to its end, where the element on the other side is as long as it may be.
  void add_within(std::size_t k, std::vector<mpcc::BranchMove>& moves) const {
    const Items items = items_of(k);
    const auto stands = [&](const Item& item) { return stands_still(item.element); };
    const auto begin = std::find_if(items.begin(), items.end(), stands);
    const auto end = std::find_if_not(begin, items.end(), stands);
    if (begin == items.begin() || end == items.end()) return;
    Items to_left(begin, items.end()), to_right(items.begin(), end);
    to_left.back().length += length_of({items.begin(), begin});
    to_right.front().length += length_of({end, items.end()});
    if (is_at_bound(*end)) add({{k, to_left}}, moves);
    if (is_at_bound(*std::prev(begin))) add({{k, to_right}}, moves);
  }

  void add(std::size_t k, const Items& before, const Items& still, const Items& after,
           std::vector<mpcc::BranchMove>& moves) const {
    const auto joined = [](Items items, const Items& more, const Items& rest) {
      items.insert(items.end(), more.begin(), more.end());
      items.insert(items.end(), rest.begin(), rest.end());
      return items;
    };
    add({{k, joined(before, still, {{after.front().element, small_share}})}, {k + 1, after}}, moves);
    add({{k, before}, {k + 1, joined({{before.back().element, small_share}}, still, after)}}, moves);
  }

  [[nodiscard]] static bool is_shorter(const Item& a, const Item& b) { return a.length < b.length; }
  [[nodiscard]] static double length_of(const Items& items) {
    double sum = 0.0;
    for (const auto& item : items) sum += item.length;
    return sum;
  }

  [[nodiscard]] Items items_of(std::size_t k) const {
    const auto& interval = made_.interval[k];
    Items items;
    for (int n = 0; n < interval.elements; ++n) {
      const auto e = at(interval.first_element + n);
      items.push_back({e, value(made_.element[e].length) * value(speed_of(k))});
    }
    return items;
  }

  [[nodiscard]] int speed_of(std::size_t k) const {
    const auto& shared = made_.kernel.shared;
    return made_.interval[k].shared[at(shared.controls + shared.parameters + shared.held + 1)];
  }

  [[nodiscard]] double value(int place) const { return value_at(place, w_, made_.constants); }

  [[nodiscard]] bool stands_still(std::size_t e) const {
    const auto clock = [&](std::size_t element) {
      return w_[made_.element[element].variable(made_.kernel.layout.right_state() + made_.kernel.clock)];
    };
    const double left = e == 0 ? value(made_.start.state[at(made_.kernel.clock)]) : clock(e - 1);
    return clock(e) - left <= vanished * value(made_.horizon) / made_.intervals;
  }

  [[nodiscard]] bool is_at_bound(const Item& item) const {
    const int h = made_.element[item.element].length;
    return h >= 0 && w_[h] > made_.w_bounds.upper[h] - vanished;
  }

  /// With these items in these intervals, if they fit.
  void add(std::vector<std::pair<std::size_t, Items>> changes, std::vector<mpcc::BranchMove>& moves) const {
    mpcc::BranchMove move{modes_.all(), w_};
    for (auto& [k, items] : changes) {
      if (!fit(items, made_.interval[k].elements)) return;
      write(k, items, move);
    }
    move.start = move.start.cwiseMax(made_.w_bounds.lower).cwiseMin(made_.w_bounds.upper);
    moves.push_back(std::move(move));
  }

  /// Joins neighbours of equal modes, or halves the longest in which time goes on, until there are so many.
  [[nodiscard]] bool fit(Items& items, int elements) const {
    while (items.size() > at(elements)) {
      const auto pair = std::adjacent_find(items.begin(), items.end(), [&](const Item& a, const Item& b) {
        return modes_.are_equal(a.element, b.element);
      });
      if (pair == items.end()) return false;
      std::next(pair)->length += pair->length;
      items.erase(pair);
    }
    while (items.size() < at(elements)) {
      const auto longest = std::max_element(items.begin(), items.end(), [&](const Item& a, const Item& b) {
        const bool a_stands = stands_still(a.element), b_stands = stands_still(b.element);
        return a_stands == b_stands ? is_shorter(a, b) : a_stands;
      });
      longest->length *= 0.5;
      items.insert(longest, *longest);
    }
    return true;
  }

  void write(std::size_t k, const Items& items, mpcc::BranchMove& move) const {
    const auto& interval = made_.interval[k];
    const double sum = length_of(items);
    move.start[speed_of(k)] = sum;
    for (std::size_t n = 0; n < items.size(); ++n) {
      const auto e = at(interval.first_element) + n;
      modes_.copy(items[n].element, e, move.sides);
      const int size = made_.kernel.layout.size - 1;
      move.start.segment(made_.element[e].first, size) = w_.segment(made_.element[items[n].element].first, size);
      if (made_.element[e].length >= 0) move.start[made_.element[e].length] = items[n].length / sum;
    }
  }

  const OcpStructure& made_;
  const ElementSides& modes_;
  ConstVectorView w_;
};

}  // namespace

void add_moved_standstills(const OcpStructure& made, const ElementSides& modes, ConstVectorView w,
                           std::vector<mpcc::BranchMove>& moves) {
  if (made.kernel.clock >= 0) MovedStandstills(made, modes, w).add_to(moves);
}

}  // namespace saltus::discretization
