#include <algorithm>
#include <iterator>

#include "saltus/discretization/ocp/element_items_internal.hpp"
#include "saltus/discretization/ocp/element_trial_internal.hpp"

namespace saltus::discretization {

double ElementItems::length_of(const Items& items) {
  double sum = 0.0;
  for (const auto& item : items) sum += item.length;
  return sum;
}

Items ElementItems::of_interval(std::size_t k) const {
  const auto& interval = made_.interval[k];
  Items items;
  for (int n = 0; n < interval.elements; ++n) {
    const auto e = at(interval.first_element + n);
    items.push_back({e, value(made_.element[e].length) * value(speed_of(k)), modes_.modes(e)});
  }
  return items;
}

int ElementItems::speed_of(std::size_t k) const { return made_.interval[k].shared[at(made_.kernel.shared.speed())]; }

bool ElementItems::stands_still(std::size_t e) const {
  if (made_.kernel.clock < 0) return false;
  const auto clock = [&](std::size_t element) {
    return w_[made_.element[element].variable(made_.kernel.layout.right_state() + made_.kernel.clock)];
  };
  const double left = e == 0 ? value(made_.start.state[at(made_.kernel.clock)]) : clock(e - 1);
  return clock(e) - left <= vanished * value(made_.horizon) / made_.intervals;
}

bool ElementItems::is_at_bound(const Item& item) const {
  const int h = made_.element[item.element].length;
  return h >= 0 && w_[h] > made_.w_bounds.upper[h] - vanished;
}

void ElementItems::add(std::vector<std::pair<std::size_t, Items>> changes, std::vector<mpcc::BranchMove>& moves) const {
  mpcc::BranchMove move{modes_.all(), w_};
  for (auto& [k, items] : changes) {
    if (!fit(items, made_.interval[k].elements)) return;
    write(k, items, move);
  }
  move.start = move.start.at_least(made_.w_bounds.lower).at_most(made_.w_bounds.upper);
  moves.push_back(std::move(move));
}

bool ElementItems::add_solved(std::size_t k, Items items, std::vector<mpcc::BranchMove>& moves) const {
  if (!fit(items, made_.interval[k].elements)) return false;
  const bool have_room = make_equal(k, items);
  const ElementTrial trial(made_, w_);
  auto left = trial.left_of(at(made_.interval[k].first_element));
  for (auto& item : items) {
    auto own = trial.solve(left, k, item.modes, item.length);
    if (!own) break;
    item.own = std::move(*own);
    left = trial.right_of(item.own);
  }
  add({{k, std::move(items)}}, moves);
  return have_room;
}

/// Neighbours of equal modes have equal lengths in a branch; false if these are longer than an element may be.
bool ElementItems::make_equal(std::size_t k, Items& items) const {
  const auto& lengths = made_.interval[k].lengths;
  const double longest = lengths.empty() ? 1.0 : made_.w_bounds.upper[lengths.front()] + small_share;
  const double sum = length_of(items);
  bool have_room = true;
  for (auto first = items.begin(); first != items.end();) {
    const auto end = std::find_if(first, items.end(), [&](const Item& item) { return item.modes != first->modes; });
    const double mean = length_of({first, end}) / static_cast<double>(end - first);
    have_room = have_room && mean <= longest * sum;
    for (; first != end; ++first) first->length = mean;
  }
  return have_room;
}

/// Joins neighbours of equal modes, or halves the longest in which time goes on, until there are so many.
bool ElementItems::fit(Items& items, int elements) const {
  while (items.size() > at(elements)) {
    const auto pair =
        std::adjacent_find(items.begin(), items.end(), [](const Item& a, const Item& b) { return a.modes == b.modes; });
    if (pair == items.end()) return false;
    std::next(pair)->length += pair->length;
    items.erase(pair);
  }
  while (items.size() < at(elements)) {
    const auto longest = std::max_element(items.begin(), items.end(), [&](const Item& a, const Item& b) {
      const bool a_stands = stands_still(a.element), b_stands = stands_still(b.element);
      return a_stands == b_stands ? a.length < b.length : a_stands;
    });
    longest->length *= 0.5;
    items.insert(longest, *longest);
  }
  return true;
}

/// An element of other modes stays where the one that it comes from ends: of that one's path it has none.
void ElementItems::begin_at_end(std::size_t from, std::size_t to, linalg::Vector& start) const {
  const auto& layout = made_.kernel.layout;
  const auto fill = [&](const VariableBlock& block, const std::vector<int>& at_end) {
    for (int group = 0; group < block.count; ++group) {
      for (int i = 0; i < block.size; ++i) start[made_.element[to].variable(block.at(group, i))] = w_[at_end[at(i)]];
    }
  };
  const auto state = right_state(made_, made_.element[from]);
  if (made_.kernel.options.representation == Representation::integral) fill(layout.stage, state);
  fill(layout.end_state, state);
  fill(layout.lambda, made_.left_lambda(static_cast<int>(from) + 1));
}

void ElementItems::write(std::size_t k, const Items& items, mpcc::BranchMove& move) const {
  const auto& interval = made_.interval[k];
  const double sum = length_of(items);
  if (speed_of(k) >= 0) move.start[speed_of(k)] = sum;
  for (std::size_t n = 0; n < items.size(); ++n) {
    const auto e = at(interval.first_element) + n;
    modes_.write(items[n].modes, e, move.sides);
    const int size = made_.kernel.layout.size - 1;
    move.start.segment(made_.element[e].first, size) = w_.segment(made_.element[items[n].element].first, size);
    if (items[n].own.size() > 0) {
      move.start.segment(made_.element[e].first, size) = items[n].own;
    } else if (items[n].modes != modes_.modes(items[n].element)) {
      begin_at_end(items[n].element, e, move.start);
    }
    if (made_.element[e].length >= 0) move.start[made_.element[e].length] = items[n].length / sum;
  }
}

}  // namespace saltus::discretization
