// States of random systems, and what their judges ask of results.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "saltus/result/result.hpp"

namespace saltus::robustness {

using State = std::vector<double>;

inline constexpr double end_time = 10.0;  // of simulations, which start at 0
inline constexpr std::array integrator_names{"dopri5", "dop853", "taylor"};

/// The largest component, at least 1.
inline double size_of(const State& x) {
  double size = 1.0;
  for (const double value : x) size = std::max(size, std::abs(value));
  return size;
}

inline double distance(const State& a, const State& b) {
  double largest = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
  return largest;
}

/// x + h slope
inline State moved(const State& x, double h, const State& slope) {
  State y = x;
  for (std::size_t i = 0; i < y.size(); ++i) y[i] += h * slope[i];
  return y;
}

/// No event that Filippov's theory leaves open.
inline bool is_unique(const result::Result& result) {
  return std::all_of(result.events.begin(), result.events.end(),
                     [](const result::Event& event) { return event.unique.value_or(false); });
}

}  // namespace saltus::robustness
