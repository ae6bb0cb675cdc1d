// Sliding on the intersection, one selection leaves the square, or both: Fig. 7 of [guglielmi2022].
#include "saltus/switching/plane/intersection.hpp"
#include "saltus/switching/plane/intersection_internal.hpp"

namespace saltus::switching {
namespace {

/// In canonical form: alpha_1 = 1 on its way out, g_1(1, alpha_2) = g_2(1, alpha_2) = 0.
LeafMode exit_right(const Plane& p, SignTests& signs) {
  const double scale = p.scale[1];
  const double below = p.f2(1, -1);
  const double above = p.f2(1, 1);
  const double alpha = sliding_alpha(below, above);
  signs.positive(std::min(alpha, 1.0 - alpha), 1.0, "distance of the other selection from the corner");
  if (signs.negative(above - below, scale, "G22")) return {Leaf::A1, {1, 0}};
  const Bilinear g2 = p.g(1);
  if (signs.positive(g2.b + g2.d * alpha, scale, "G21")) return {Leaf::A2, {1, -1}};
  return {Leaf::A3, {1, 1}};
}

}  // namespace

PlaneDecision decide_exit_edge(const PlaneTable& table, SquareEdge edge) {
  SALTUS_ASSERT(edge.surface < 2 && (edge.side == 1 || edge.side == -1));
  const Plane plane(table);
  PlaneMode outward{};
  outward[edge.surface] = edge.side;
  const auto symmetry = find_symmetry([outward](const PlaneSymmetry& s) {
    return s.apply(outward) == PlaneMode{1, 0};
  });
  SALTUS_ASSERT(symmetry.has_value());
  SignTests signs;
  const LeafMode found = exit_right(symmetry->apply(plane), signs);
  return conclude(table, found.leaf, symmetry->apply_inverse(found.mode), signs, admissible_modes(table));
}

}  // namespace saltus::switching
