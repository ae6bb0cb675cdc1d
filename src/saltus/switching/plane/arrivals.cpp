// Straight to the intersection: a classical solution that reaches both surfaces at once, and a start there.
#include "saltus/switching/plane/intersection.hpp"
#include "saltus/switching/plane/intersection_internal.hpp"
#include "saltus/switching/plane/spiral.hpp"

namespace saltus::switching {
namespace {

/// Follows the solution of the constant fields that passes beside the intersection and reaches `surface` first.
class Walk {
 public:
  Walk(const PlaneTable& table, const Plane& plane, SignTests& signs) : table_(table), plane_(plane), signs_(signs) {}

  PlaneMode from(PlaneMode region, std::size_t surface) const {
    // It does not come back: the field of the first region points to both surfaces, so that it is not entered again.
    for (int crossings = 0; crossings < 4; ++crossings) {
      PlaneMode beyond = region;
      beyond[surface] = -region[surface];
      if (!moves(beyond, surface, beyond[surface])) return slide(region, surface);
      region = beyond;
      surface = 1 - surface;
      if (moves(region, surface, region[surface])) return region;
    }
    signs_.fail("field of the region before, which does not point to both surfaces");
    return region;
  }

 private:
  static std::size_t corner(const PlaneMode& region) { return (region[0] > 0 ? 1U : 0U) + (region[1] > 0 ? 2U : 0U); }

  /// Whether the field of `region` moves psi_surface in this direction.
  [[nodiscard]] bool moves(const PlaneMode& region, std::size_t surface, int direction) const {
    return signs_.positive(direction * plane_.f[surface][corner(region)], plane_.scale[surface],
                           "normal component of a field at the intersection");
  }

  [[nodiscard]] PlaneMode slide(PlaneMode region, std::size_t surface) const {
    const std::size_t other = 1 - surface;
    PlaneMode sliding = region;
    sliding[surface] = 0;
    const double alpha = continuation(table_, sliding).alpha[surface];
    const std::size_t base = corner(region) & ~(std::size_t{1} << surface);
    const double velocity =
        (1.0 - alpha) * plane_.f[other][base] + alpha * plane_.f[other][base | std::size_t{1} << surface];
    if (signs_.positive(sliding[other] * velocity, plane_.scale[other], "velocity along the surface reached first")) {
      return sliding;
    }
    const PlaneDecision entered = decide_entering(table_, sliding);
    if (!entered.undecided.empty()) signs_.fail(entered.undecided);
    if (entered.ambiguous) signs_.fail("scaling of the surfaces");
    return entered.chosen.mode;
  }

  const PlaneTable& table_;
  const Plane& plane_;
  SignTests& signs_;
};

int sliding_surfaces(const PlaneMode& mode) { return (mode[0] == 0 ? 1 : 0) + (mode[1] == 0 ? 1 : 0); }

/// Order of preference among modes that attract.
bool precedes(const PlaneMode& a, const PlaneMode& b) {
  if (sliding_surfaces(a) != sliding_surfaces(b)) return sliding_surfaces(a) > sliding_surfaces(b);
  return a > b;
}

}  // namespace

PlaneDecision decide_corner_arrival(const PlaneTable& table, PlaneMode incoming) {
  SALTUS_ASSERT(incoming[0] * incoming[0] == 1 && incoming[1] * incoming[1] == 1);
  const Plane plane(table);
  SignTests signs;
  const Walk walk(table, plane, signs);
  const PlaneMode first = walk.from(incoming, 0);
  const PlaneMode second = walk.from(incoming, 1);
  const bool same = first == second;
  if (!same) signs.fail("order in which the surfaces are reached");
  PlaneDecision decision = conclude(table, same ? Leaf::P1 : Leaf::P2, first, signs, admissible_modes(table));
  decision.ambiguous = !same;
  return decision;
}

PlaneDecision decide_intersection_start(const PlaneTable& table) {
  const PlaneModes admissible = admissible_modes(table);
  SignTests signs;
  const PlaneContinuation* best = nullptr;
  std::size_t attracting = 0;
  for (const PlaneContinuation& mode : admissible) {
    attracting += mode.attracts ? 1 : 0;
    const bool better = best == nullptr || (mode.attracts && !best->attracts) ||
                        (mode.attracts == best->attracts && precedes(mode.mode, best->mode));
    if (better) best = &mode;
  }
  if (best == nullptr) {
    signs.fail("admissible mode at the start");
    return conclude(table, Leaf::none, {0, 0}, signs, admissible);
  }
  if (!best->attracts && turning(table)) {
    // Sliding on an unstable root, or out: as where sliding loses its root (exit (c)).
    PlaneDecision decision = conclude(table, Leaf::spiral_out, {-1, -1}, signs, admissible);
    decision.spirals_out = decision.ambiguous = true;
    return decision;
  }
  const Leaf leaf = admissible.size() == 1 ? Leaf::S1 : attracting == 1 ? Leaf::S2 : Leaf::S3;
  PlaneDecision decision = conclude(table, leaf, best->mode, signs, admissible);
  decision.ambiguous = attracting > 1;
  return decision;
}

PlaneDecision decide_spiral_in(const PlaneTable& table) {
  SignTests signs;
  const auto cycle = spiral_cycle(table, 0);
  if (!cycle || !signs.negative(cycle->cycle_ratio - 1.0, 1.0, "ratio of successive cycles of the spiral")) {
    signs.fail("turning of the four fields around the intersection");
  }
  return conclude(table, Leaf::spiral_in, {0, 0}, signs, admissible_modes(table));
}

}  // namespace saltus::switching
