#include "saltus/switching/table/surface_decision.hpp"

#include <utility>

namespace saltus::switching {
namespace {

SurfaceDecision leaves(int mode, std::string_view reason) {
  return {Verdict::decided, mode, mode > 0 ? 1.0 : 0.0, {}, reason};
}

SurfaceDecision not_unique(int mode, std::vector<int> others, std::string_view reason) {
  return {Verdict::decided, mode, mode > 0 ? 1.0 : 0.0, std::move(others), reason};
}

SurfaceDecision slides(const SurfaceSituation& s) {
  if (s.below.velocity == 0.0 && s.above.velocity == 0.0) {
    return {Verdict::two_fold, 0, 0.5, {}, "both fields are tangent to the surface (two-fold)"};
  }
  return {Verdict::decided,
          0,
          sliding_alpha(s.below.velocity, s.above.velocity),
          {},
          "both fields point to the surface: sliding"};
}

}  // namespace

double sliding_alpha(double velocity_below, double velocity_above) {
  return velocity_below / (velocity_below - velocity_above);
}

SurfaceDecision decide_surface(const SurfaceSituation& s) {
  const Drift below = s.below.drift;
  const Drift above = s.above.drift;
  if (below == Drift::up && above == Drift::up) return leaves(+1, "both fields point to psi > 0");
  if (below == Drift::down && above == Drift::down) return leaves(-1, "both fields point to psi < 0");
  if (below == Drift::up && above == Drift::down) return slides(s);
  if (below == Drift::down && above == Drift::up) {
    return not_unique(+1, {-1, 0}, "both fields point away from the surface: psi > 0 chosen");
  }
  if (below == Drift::stays && above == Drift::stays) {
    return {Verdict::stands, 0, 0.5, {}, "psi stays 0 under both fields"};
  }
  // One field moves along the surface, the other is transversal.
  if (below == Drift::stays) {
    return above == Drift::down
               ? SurfaceDecision{Verdict::decided, 0, 0.0, {}, "the field below moves along the surface"}
               : not_unique(+1, {0}, "the field above leaves, the one below moves along the surface");
  }
  return below == Drift::up ? SurfaceDecision{Verdict::decided, 0, 1.0, {}, "the field above moves along the surface"}
                            : not_unique(-1, {0}, "the field below leaves, the one above moves along the surface");
}

}  // namespace saltus::switching
