// Which entries of the derivatives at a point are kept: all of them, or those that can be other than 0.
#pragma once

#include <cstddef>
#include <vector>

#include "saltus/base/at.hpp"

namespace saltus::discretization {

/// Holds entries of a matrix by columns, rows ascending, and where those of a row are among them.
struct EntryPattern {
  int rows = 0, columns = 0;
  std::vector<int> start, row;                ///< by columns: columns + 1, one per entry
  std::vector<int> row_start, column, place;  ///< by rows: rows + 1, one per entry; `place`: which one by columns

  [[nodiscard]] std::size_t size() const { return row.size(); }
};

/// Holds the patterns of the derivatives of StageValues.
struct StagePattern {
  EntryPattern f_x, f_selection, indicator_x;
  /// Whether only those that can be other than 0 are kept, and linear systems are solved by their entries.
  bool is_sparse = false;
};

/// Calls visit(row, value) for the entries of a column, rows ascending.
template <class Visit>
void visit_column(const EntryPattern& pattern, const std::vector<double>& values, std::size_t column, Visit&& visit) {
  for (int e = pattern.start[column]; e < pattern.start[column + 1]; ++e) visit(at(pattern.row[at(e)]), values[at(e)]);
}

/// Calls visit(column, value) for the entries of a row, columns ascending.
template <class Visit>
void visit_row(const EntryPattern& pattern, const std::vector<double>& values, std::size_t row, Visit&& visit) {
  for (int e = pattern.row_start[row]; e < pattern.row_start[row + 1]; ++e) {
    visit(at(pattern.column[at(e)]), values[at(pattern.place[at(e)])]);
  }
}

}  // namespace saltus::discretization
