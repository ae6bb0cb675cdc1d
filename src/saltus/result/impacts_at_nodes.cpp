#include "saltus/result/impacts_at_nodes.hpp"

#include <algorithm>
#include <cmath>

namespace saltus::result {

std::vector<double> impacts_at_nodes(const Result& result) {
  std::vector<double> times;
  if (!result.optimization || result.optimization->grid.size() < 3) return times;
  const auto& grid = result.optimization->grid;
  for (const auto& event : result.events) {
    const auto is_here = [&](double node) { return std::abs(event.t - node) <= 1e-9 * (grid.back() - grid.front()); };
    if (event.kind == EventKind::impact && std::any_of(grid.begin() + 1, grid.end() - 1, is_here))
      times.push_back(event.t);
  }
  return times;
}

}  // namespace saltus::result
