#include "saltus/ode/sparse/elimination.hpp"

#include <algorithm>

#include "saltus/base/at.hpp"
#include "saltus/base/without_repeats.hpp"
#include "saltus/linalg/sparse_factors.hpp"
#include "saltus/ode/sparse/pattern_places_internal.hpp"

namespace saltus::ode {
namespace {

using Neighbours = std::vector<std::vector<std::size_t>>;

RowLists joined(const Neighbours& rows) {
  RowLists lists{{0}, {}};
  for (const auto& row : rows) {
    lists.column.insert(lists.column.end(), row.begin(), row.end());
    lists.start.push_back(lists.column.size());
  }
  return lists;
}

RowLists transposed(const RowLists& lists) {
  Neighbours rows(lists.start.size() - 1);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (std::size_t k = lists.start[i]; k < lists.start[i + 1]; ++k) rows[lists.column[k]].push_back(i);
  }
  return joined(rows);
}

/// What is eliminated leaves its neighbours to the first of them, its parent in the elimination tree.
RowLists filled(Neighbours later) {
  for (std::size_t i = 0; i < later.size(); ++i) {
    auto& own = later[i];
    drop_repeats(own);
    if (!own.empty()) later[own.front()].insert(later[own.front()].end(), own.begin() + 1, own.end());
  }
  return joined(later);
}

}  // namespace

Elimination elimination_of(const JacobianPattern& pattern) {
  const std::size_t n = pattern.columns();
  Elimination elimination;
  const PatternPlaces places(pattern);
  elimination.order = linalg::order_of_least_degree(index(n), places.start, places.row);
  std::vector<std::size_t> place(n);
  for (std::size_t i = 0; i < n; ++i) place[elimination.order[i]] = i;
  struct Entry {
    std::size_t column, slot;
  };
  std::vector<std::vector<Entry>> rows(n);
  Neighbours later(n);
  for (std::size_t j = 0; j < n; ++j) {
    for (std::size_t k = pattern.start[j]; k < pattern.start[j + 1]; ++k) {
      const auto [first, second] = std::minmax(place[pattern.row[k]], place[j]);
      rows[place[pattern.row[k]]].push_back({place[j], k});
      if (first != second) later[first].push_back(second);
    }
  }
  elimination.entries.start.push_back(0);
  for (const auto& row : rows) {
    for (const Entry& entry : row) {
      elimination.entries.column.push_back(entry.column);
      elimination.slot.push_back(entry.slot);
    }
    elimination.entries.start.push_back(elimination.slot.size());
  }
  elimination.upper = filled(std::move(later));
  elimination.lower = transposed(elimination.upper);
  return elimination;
}

}  // namespace saltus::ode
