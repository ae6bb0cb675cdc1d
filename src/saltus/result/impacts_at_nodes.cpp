#include "saltus/result/impacts_at_nodes.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace saltus::result {

std::string impacts_at_nodes(const Result& result) {
  std::string times;
  if (!result.optimization || result.optimization->grid.size() < 3) return times;
  const auto& grid = result.optimization->grid;
  for (const auto& event : result.events) {
    const auto is_here = [&](double node) { return std::abs(event.t - node) <= 1e-9 * (grid.back() - grid.front()); };
    if (event.kind != EventKind::impact || std::none_of(grid.begin() + 1, grid.end() - 1, is_here)) continue;
    times += fmt::format("{}{:.6g}", times.empty() ? "" : ", ", event.t);
  }
  return times;
}

}  // namespace saltus::result
