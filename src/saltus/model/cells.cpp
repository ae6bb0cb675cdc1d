#include "saltus/model/cells.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "saltus/base/at.hpp"

namespace saltus::model {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Slopes of the not-a-knot spline at its points: its second derivative is continuous, its third one also at the second
/// and the last but one point. Tridiagonal but for the first and last row, which reach one column further; elimination
/// without exchange of rows is stable here [deboor2001, chapter IV].
std::vector<double> spline_slopes(const std::vector<double>& x, const std::vector<double>& y) {
  const std::size_t n = x.size() - 1;
  const auto h = [&](std::size_t k) { return x[k + 1] - x[k]; };
  const auto secant = [&](std::size_t k) { return (y[k + 1] - y[k]) / h(k); };
  std::vector<double> diagonal(n + 1), above(n + 1), slope(n + 1);
  // The row of h_1 s_0 + (h_0 + h_1) s_1: the two pieces that meet at x_1 are one cubic.
  const double first = h(0) + h(1);
  diagonal[0] = h(1);
  above[0] = first;
  slope[0] = ((h(0) + 2.0 * first) * h(1) * secant(0) + h(0) * h(0) * secant(1)) / first;
  for (std::size_t k = 1; k < n; ++k) {
    const double factor = h(k) / diagonal[k - 1];
    diagonal[k] = 2.0 * (h(k - 1) + h(k)) - factor * above[k - 1];
    above[k] = h(k - 1);
    slope[k] = 3.0 * (h(k) * secant(k - 1) + h(k - 1) * secant(k)) - factor * slope[k - 1];
  }
  const double last = h(n - 1) + h(n - 2);
  const double right =
      (h(n - 1) * h(n - 1) * secant(n - 2) + (2.0 * last + h(n - 1)) * h(n - 2) * secant(n - 1)) / last;
  const double factor = last / diagonal[n - 1];
  slope[n] = (right - factor * slope[n - 1]) / (h(n - 2) - factor * above[n - 1]);
  for (std::size_t k = n; k-- > 0;) slope[k] = (slope[k] - above[k] * slope[k + 1]) / diagonal[k];
  return slope;
}

std::optional<PointMistake> find_point_mistake(const std::vector<double>& x, const std::vector<double>& y,
                                               std::size_t fewest, const std::string& what) {
  if (x.size() != y.size()) {
    return PointMistake{fmt::format("{} arguments, but {} values", x.size(), y.size()),
                        "every argument needs its value"};
  }
  if (x.size() < fewest) {
    return PointMistake{
        fmt::format("expected at least {} point{} for {}, found {}", fewest, fewest == 1 ? "" : "s", what, x.size()),
        fewest == 4 ? "add points, or use kind = \"linear\"" : "add points"};
  }
  if (x.size() > most_points) {
    return PointMistake{fmt::format("{} points; at most {} are possible", x.size(), most_points), "thin them out"};
  }
  for (std::size_t k = 0; k < x.size(); ++k) {
    for (const bool value : {false, true}) {
      const double number = value ? y[k] : x[k];
      if (!std::isfinite(number)) {
        return PointMistake{fmt::format("expected a finite number, found {}", number), "remove the point", k, value};
      }
    }
    if (k > 0 && !(x[k] > x[k - 1])) {
      return PointMistake{fmt::format("the arguments must ascend, found {} after {}", x[k], x[k - 1]),
                          "sort the points, each argument once", k};
    }
    // The slope between neighbours must be a number, too.
    if (k > 0 && !std::isfinite((y[k] - y[k - 1]) / (x[k] - x[k - 1]))) {
      return PointMistake{fmt::format("the slope between the points at {} and {} is not finite", x[k - 1], x[k]),
                          "remove one of them", k};
    }
  }
  return std::nullopt;
}

}  // namespace

long CellTable::cell(double argument) const {
  if (std::isnan(argument)) return 0;
  if (kind == Breaks::listed) return std::upper_bound(breaks.begin(), breaks.end(), argument) - breaks.begin();
  // Beyond 2^53 neighbouring integers are one double; there the cells have no meaning any more.
  constexpr double largest = 0x1p53;
  return static_cast<long>(std::floor(std::clamp(argument, -largest, largest)));
}

double CellTable::lower(long cell) const {
  if (kind == Breaks::integers) return static_cast<double>(cell);
  return cell <= 0 ? -infinity : breaks[at(cell - 1)];
}

double CellTable::upper(long cell) const {
  if (kind == Breaks::integers) return static_cast<double>(cell + 1);
  return cell >= static_cast<long>(breaks.size()) ? infinity : breaks[at(cell)];
}

double CellTable::constant(long cell, int column) const {
  if (kind == Breaks::integers) return static_cast<double>(cell);
  return constants[static_cast<std::size_t>(cell) * static_cast<std::size_t>(columns) +
                   static_cast<std::size_t>(column)];
}

CellTable integer_cells() { return {}; }

CellTable table_cells(const std::vector<double>& x, const std::vector<double>& y, TableKind kind) {
  CellTable table;
  table.kind = CellTable::Breaks::listed;
  table.change = CellTable::Change::kink;
  table.columns = kind == TableKind::linear ? 3 : 5;
  table.breaks = x;
  const std::size_t n = x.size() - 1;
  const auto add = [&](std::initializer_list<double> row) {
    table.constants.insert(table.constants.end(), row);
    table.constants.resize(table.constants.size() + static_cast<std::size_t>(table.columns) - row.size(), 0.0);
  };
  add({x.front(), y.front()});
  const auto slope = kind == TableKind::cubic ? spline_slopes(x, y) : std::vector<double>{};
  for (std::size_t k = 0; k < n; ++k) {
    const double h = x[k + 1] - x[k], secant = (y[k + 1] - y[k]) / h;
    if (kind == TableKind::linear) {
      add({x[k], y[k], secant});
    } else {
      add({x[k], y[k], slope[k], (3.0 * secant - 2.0 * slope[k] - slope[k + 1]) / h,
           (slope[k] + slope[k + 1] - 2.0 * secant) / (h * h)});
    }
  }
  add({x.back(), y.back()});
  return table;
}

CellTable step_cells(const std::vector<double>& t, const std::vector<double>& values) {
  CellTable table;
  table.kind = CellTable::Breaks::listed;
  table.constants.push_back(values.front());
  for (std::size_t k = 1; k < t.size(); ++k) {
    if (values[k] == table.constants.back()) continue;
    table.breaks.push_back(t[k]);
    table.constants.push_back(values[k]);
  }
  return table;
}

std::optional<PointMistake> find_mistake(const std::vector<double>& x, const std::vector<double>& y, TableKind kind) {
  return kind == TableKind::linear ? find_point_mistake(x, y, 2, "a linear table")
                                   : find_point_mistake(x, y, 4, "a cubic table");
}

std::optional<PointMistake> find_mistake(const std::vector<double>& t, const std::vector<double>& values) {
  return find_point_mistake(t, values, 1, "an input");
}

}  // namespace saltus::model
