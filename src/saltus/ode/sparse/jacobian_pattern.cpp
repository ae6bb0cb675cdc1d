#include "saltus/ode/sparse/jacobian_pattern.hpp"

#include <algorithm>

namespace saltus::ode {

JacobianPattern pattern_of(std::size_t n, std::vector<std::pair<std::size_t, std::size_t>> entries) {
  for (std::size_t i = 0; i < n; ++i) entries.emplace_back(i, i);
  std::sort(entries.begin(), entries.end(),
            [](const auto& a, const auto& b) { return std::pair(a.second, a.first) < std::pair(b.second, b.first); });
  entries.erase(std::unique(entries.begin(), entries.end()), entries.end());
  JacobianPattern pattern;
  pattern.start.assign(n + 1, 0);
  for (const auto& [row, column] : entries) {
    pattern.row.push_back(row);
    ++pattern.start[column + 1];
  }
  for (std::size_t k = 0; k < n; ++k) pattern.start[k + 1] += pattern.start[k];
  return pattern;
}

std::vector<std::vector<std::size_t>> column_groups(const JacobianPattern& pattern) {
  const std::size_t n = pattern.columns();
  std::vector<std::vector<std::size_t>> columns_of_row(n);
  for (std::size_t column = 0; column < n; ++column) {
    for (std::size_t k = pattern.start[column]; k < pattern.start[column + 1]; ++k) {
      columns_of_row[pattern.row[k]].push_back(column);
    }
  }
  constexpr std::size_t none = static_cast<std::size_t>(-1);
  std::vector<std::size_t> group_of(n, none);
  std::vector<std::size_t> taken_by;  // by group: the last column that met it
  std::vector<std::vector<std::size_t>> groups;
  for (std::size_t column = 0; column < n; ++column) {
    for (std::size_t k = pattern.start[column]; k < pattern.start[column + 1]; ++k) {
      for (const std::size_t other : columns_of_row[pattern.row[k]]) {
        if (other < column) taken_by[group_of[other]] = column;
      }
    }
    const auto free = std::find_if(taken_by.begin(), taken_by.end(), [&](std::size_t by) { return by != column; });
    const auto group = static_cast<std::size_t>(free - taken_by.begin());
    if (free == taken_by.end()) {
      taken_by.push_back(none);
      groups.emplace_back();
    }
    group_of[column] = group;
    groups[group].push_back(column);
  }
  return groups;
}

}  // namespace saltus::ode
