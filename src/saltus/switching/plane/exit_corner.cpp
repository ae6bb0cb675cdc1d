// Sliding on the intersection, both selections leave_by_corner the square at once.
#include "saltus/switching/plane/intersection.hpp"
#include "saltus/switching/plane/intersection_internal.hpp"

namespace saltus::switching {
namespace {

/// In canonical form the corner is (+, +). Close to it, with w = u - 1, the root beyond is at w = delta > 0 (both). The
/// hidden dynamics is w' = G (min(w, 0) - delta). It starts from w = 0 with w' = r = -G delta, the drifts of f^{++}.
LeafMode leave_by_corner(const Plane& p, const std::array<Drift, 2>& r, SignTests& signs) {
  const bool first_out = r[0] == Drift::up;
  const bool second_out = r[1] == Drift::up;
  if (r[0] == Drift::stays || r[1] == Drift::stays) signs.fail("drift of f(++) at the corner");
  if (first_out && second_out) return {Leaf::K1, {1, 1}};
  if (!first_out) {
    signs.fail("drift of f(++) at the corner");  // exchange makes the first one leave_by_corner, or neither does
    return {Leaf::none, {0, 0}};
  }
  // w_1 > 0 > w_2 from now on: w_2' = r_2 + G22 w_2.
  const double g22 = p.f2(1, 1) - p.f2(1, -1);
  if (signs.negative(g22, p.scale[1], "G22 at the corner")) return {Leaf::K2, {1, 0}};
  const double g12 = p.f1(1, 1) - p.f1(1, -1);
  if (signs.positive(g12, p.scale[0], "G12 at the corner")) signs.fail("G12 > 0 and G22 > 0 at the corner");
  return {Leaf::K3, {1, -1}};
}

}  // namespace

PlaneDecision decide_exit_corner(const PlaneTable& table, PlaneMode corner) {
  SALTUS_ASSERT(corner[0] * corner[0] == 1 && corner[1] * corner[1] == 1);
  const std::size_t index = (corner[0] > 0 ? 1U : 0U) + (corner[1] > 0 ? 2U : 0U);
  const auto outward = [&](std::size_t j) {
    return static_cast<Drift>(static_cast<int>(table.side(j, index).drift) * corner[j]);
  };
  PlaneSymmetry symmetry{corner[0] < 0, corner[1] < 0, false};
  std::array<Drift, 2> drifts{outward(0), outward(1)};
  if (drifts[0] != Drift::up) {
    symmetry.exchange = true;
    std::swap(drifts[0], drifts[1]);
  }
  SignTests signs;
  const LeafMode found = leave_by_corner(symmetry.apply(Plane(table)), drifts, signs);
  const PlaneMode mode = symmetry.apply_inverse(found.mode);
  PlaneDecision decision = conclude(table, found.leaf, mode, signs, admissible_modes(table));
  if (found.leaf == Leaf::K2) decision.chosen = continuation(table, mode);
  return decision;
}

}  // namespace saltus::switching
