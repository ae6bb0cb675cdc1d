#include "saltus/switching/regions/region_spiral.hpp"

#include <array>
#include <cstddef>
#include <numeric>

#include "saltus/linalg/factors.hpp"

namespace saltus::switching {
namespace {

using Facets = std::array<std::size_t, 2>;

/// The edges that meet at a vertex of a polygon; nullopt of a point that is none.
std::optional<Facets> edges_at(const RegionPolytope& polytope, int region) {
  std::vector<std::size_t> edges;
  for (std::size_t f = 0; f < polytope.facets().size(); ++f) {
    if ((polytope.facets()[f] >> region & 1U) != 0) edges.push_back(f);
  }
  return edges.size() == 2 ? std::optional(Facets{edges[0], edges[1]}) : std::nullopt;
}

/// The other vertex of an edge.
int beyond(const RegionPolytope& polytope, std::size_t edge, int region) {
  for (int i = 0; i < polytope.regions(); ++i) {
    if (i != region && (polytope.facets()[edge] >> i & 1U) != 0 && edges_at(polytope, i)) return i;
  }
  return -1;
}

/// From vertex to vertex, the first one entered over the edge `entry`.
std::optional<RegionCycle> cycle_over(const RegionTie& tie, int first, std::size_t entry) {
  const auto border = [&](std::size_t edge) -> linalg::Vector {
    return -tie.polytope.normals().row(static_cast<linalg::Index>(edge)).normalized();
  };
  RegionCycle cycle;
  cycle.cycle_ratio = 1.0;
  int region = first;
  std::size_t edge = entry;
  do {
    const auto edges = edges_at(tie.polytope, region);
    if (!edges || cycle.regions.size() > static_cast<std::size_t>(tie.polytope.regions())) return std::nullopt;
    const std::size_t exit = (*edges)[0] == edge ? (*edges)[1] : (*edges)[0];
    linalg::Matrix directions(2, 2);
    directions.col(0) = -tie.rates.col(region);
    directions.col(1) = border(exit);
    const linalg::Vector parts = linalg::Lu(directions).solve(border(edge));
    if (!(parts[0] > 0.0 && parts[1] > 0.0) || !parts.all_finite()) return std::nullopt;
    cycle.regions.push_back(region);
    cycle.durations.push_back(cycle.cycle_ratio * parts[0]);
    cycle.cycle_ratio *= parts[1];
    region = beyond(tie.polytope, exit, region);
    edge = exit;
  } while (region != first && region >= 0);
  return region == first ? std::optional(std::move(cycle)) : std::nullopt;
}

}  // namespace

double RegionCycle::duration() const { return std::accumulate(durations.begin(), durations.end(), 0.0); }

std::optional<RegionCycle> region_spiral(const RegionTie& tie) {
  if (tie.polytope.dimension() != 2) return std::nullopt;
  for (int region = 0; region < tie.polytope.regions(); ++region) {
    const auto edges = edges_at(tie.polytope, region);
    if (!edges) continue;
    for (const std::size_t entry : *edges) {
      if (auto cycle = cycle_over(tie, region, entry)) return cycle;
    }
    return std::nullopt;
  }
  return std::nullopt;
}

}  // namespace saltus::switching
