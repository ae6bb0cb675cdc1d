// The columns of a trajectory in a page.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include "saltus/report/json_internal.hpp"
#include "saltus/report/thinning_internal.hpp"

namespace saltus::report {

/// Beyond this many columns each one is kept by the points that its lines need.
inline constexpr std::size_t many_columns = 64;
/// How far lines between points may then be from the values, in parts of the range of a column.
inline constexpr double least_line_tolerance = 5e-4;

/// Says how the columns of one trajectory are kept.
struct KeptRows {
  std::vector<std::size_t> rows;
  std::vector<double> t;        ///< of them
  double line_tolerance = 0.0;  ///< 0: all values
};

/// Returns values of one column at rows; one that is too short counts as not a number there.
template <class Table>
[[nodiscard]] std::vector<double> values_of(const Table& table, const std::vector<std::size_t>& rows,
                                            std::size_t column) {
  std::vector<double> values(rows.size(), std::numeric_limits<double>::quiet_NaN());
  for (std::size_t i = 0; i < rows.size() && rows[i] < table.size(); ++i) {
    const auto& row = table[rows[i]];
    if (column < row.size()) values[i] = static_cast<double>(row[column]);
  }
  return values;
}

/// Returns the points of a column that its lines need.
[[nodiscard]] inline std::vector<std::size_t> points_of(const KeptRows& kept, const std::vector<double>& values) {
  double least = std::numeric_limits<double>::infinity(), greatest = -least;
  for (const double value : values) {
    if (std::isfinite(value)) least = std::min(least, value), greatest = std::max(greatest, value);
  }
  return straight_places(kept.t, values, least < greatest ? kept.line_tolerance * (greatest - least) : 0.0);
}

/// Returns one array per column: its values, or {"$points": [places, values], "size": rows}.
template <class Table>
[[nodiscard]] nlohmann::json kept_columns(const Table& table, const KeptRows& kept, std::size_t width) {
  nlohmann::json columns = nlohmann::json::array();
  for (std::size_t column = 0; column < width; ++column) {
    const auto values = values_of(table, kept.rows, column);
    if (kept.line_tolerance == 0.0) {
      columns.push_back(values);
      continue;
    }
    auto places = points_of(kept, values);
    std::vector<double> at_places;
    at_places.reserve(places.size());
    for (const std::size_t place : places) at_places.push_back(values[place]);
    columns.push_back({{"$points", {std::move(places), std::move(at_places)}}, {"size", values.size()}});
  }
  return columns;
}

}  // namespace saltus::report
