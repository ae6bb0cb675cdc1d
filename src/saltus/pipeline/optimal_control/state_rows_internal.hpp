// States of a motion over time, as results and problems have them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "saltus/base/at.hpp"
#include "saltus/model/system.hpp"
#include "saltus/model/time_freezing/time_freezing.hpp"

namespace saltus::pipeline {

/// Returns values of a trajectory at a time: straight lines between its rows.
template <class Rows>
std::vector<double> row_at(const std::vector<double>& t, const Rows& rows, double time) {
  const auto behind = std::upper_bound(t.begin(), t.end(), time);
  if (behind == t.begin()) return rows.front();
  if (behind == t.end()) return rows.back();
  const auto i = static_cast<std::size_t>(behind - t.begin());
  const double length = t[i] - t[i - 1];
  const double share = length > 0.0 ? (time - t[i - 1]) / length : 1.0;
  std::vector<double> row = rows[i - 1];
  for (std::size_t k = 0; k < row.size(); ++k) row[k] += share * (rows[i][k] - rows[i - 1][k]);
  return row;
}

/// Returns a row of a result at a time, with the clock and the other hidden states of frozen time, which are 0.
inline std::vector<double> with_hidden_states(const model::System& system, std::vector<double> x, double t) {
  x.resize(system.state_names.size(), 0.0);
  if (system.freezing) x[at(system.freezing->clock)] = t;
  return x;
}

}  // namespace saltus::pipeline
