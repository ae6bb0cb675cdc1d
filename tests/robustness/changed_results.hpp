// Results with planted mistakes.
#pragma once

#include <vector>

#include "saltus/result/result.hpp"

namespace saltus::robustness {

/// Changes the events of a result as a list.
template <class Change>
void change_events(result::Result& result, Change change) {
  std::vector<result::Event> events = result.events;
  change(events);
  result.events = events;
}

/// Changes the rows of a table as a list of `Row`s.
template <class Row, class Table, class Change>
void change_rows(Table& table, Change change) {
  std::vector<Row> rows(table.begin(), table.end());
  change(rows);
  table = {};
  for (const Row& row : rows) table.push_back(row);
}

}  // namespace saltus::robustness
