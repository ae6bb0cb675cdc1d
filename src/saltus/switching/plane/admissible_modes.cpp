#include "saltus/switching/plane/admissible_modes.hpp"

#include <algorithm>

#include "saltus/switching/plane/intersection_internal.hpp"

namespace saltus::switching {
namespace {

bool points_to(const Side& side, int k) { return static_cast<int>(side.drift) == k; }

void push_roots(const IntersectionRoots& roots, PlaneModes& modes) {
  for (const auto& root : {roots.rising, roots.falling}) {
    if (!root) continue;
    const auto [low, high] = std::minmax(root->alpha[0], root->alpha[1]);
    if (low > sign_tolerance && high < 1.0 - sign_tolerance) modes.push({{0, 0}, root->alpha, root->stabilisable()});
  }
}

/// Sliding on `surface`, to the sides of the other one.
void push_edges(const PlaneTable& table, const Plane& plane, std::size_t surface, PlaneModes& modes) {
  const std::size_t other = 1 - surface;
  for (const int k : {-1, 1}) {
    const std::size_t base = k > 0 ? std::size_t{1} << other : 0;
    const std::size_t above_corner = base | std::size_t{1} << surface;
    const Side& below = table.side(surface, base);
    const Side& above = table.side(surface, above_corner);
    if (below.drift == Drift::stays || above.drift == Drift::stays || below.drift == above.drift) continue;
    if (below.velocity == above.velocity) continue;
    const double alpha = sliding_alpha(below.velocity, above.velocity);
    const double outward = k * ((1.0 - alpha) * plane.f[other][base] + alpha * plane.f[other][above_corner]);
    if (!(outward > sign_tolerance * plane.scale[other])) continue;
    PlaneContinuation edge;
    edge.mode[other] = k;
    edge.alpha[surface] = alpha;
    edge.alpha[other] = k > 0 ? 1.0 : 0.0;
    edge.attracts = below.drift == Drift::up;
    modes.push(edge);
  }
}

}  // namespace

PlaneModes admissible_modes(const PlaneTable& table) {
  const Plane plane(table);
  return admissible_modes(table, plane, intersection_roots(plane));
}

PlaneModes admissible_modes(const PlaneTable& table, const Plane& plane, const IntersectionRoots& roots) {
  PlaneModes modes;
  push_roots(roots, modes);
  push_edges(table, plane, 0, modes);
  push_edges(table, plane, 1, modes);
  for (std::size_t corner = 0; corner < 4; ++corner) {
    const PlaneMode k{(corner & 1U) != 0 ? 1 : -1, (corner & 2U) != 0 ? 1 : -1};
    if (!points_to(table.side(0, corner), k[0]) || !points_to(table.side(1, corner), k[1])) continue;
    modes.push({k, {k[0] > 0 ? 1.0 : 0.0, k[1] > 0 ? 1.0 : 0.0}, true});
  }
  return modes;
}

}  // namespace saltus::switching
