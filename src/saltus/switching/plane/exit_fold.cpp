// Sliding on the intersection ends because its two roots coalesce and vanish: Fig. 8 of [guglielmi2022].
#include "saltus/switching/plane/intersection.hpp"
#include "saltus/switching/plane/intersection_internal.hpp"

namespace saltus::switching {
namespace {

/// The double root and how the curves g_1 = 0, g_2 = 0 touch there.
struct Touching {
  std::array<double, 2> up{};         ///< p_j = G_j2: sign of the direction in which curve j is run through
  std::array<double, 2> curvature{};  ///< d_j / p_j

  Touching(const Plane& p, const PlaneAlpha& root) {
    for (std::size_t j = 0; j < 2; ++j) {
      const Bilinear g = p.g(j);
      up[j] = g.c + g.d * root[0];
      curvature[j] = g.d / up[j];
    }
  }
};

/// In canonical form: both curves have positive slope (H_1 < 0, H_2 < 0), g_2 = 0 lies above g_1 = 0.
/// NOTE: the printed signs of the first and the impossible case are exchanged (d_2 g_1 > 0, d_1 g_2 < 0 is "both up").
LeafMode leave_by_fold(const Plane& p, const Touching& touching, SignTests& signs) {
  const auto [s1, s2] = p.scale;
  const bool first_up = signs.positive(touching.up[0], s1, "G12 at the double root");
  const bool second_up = signs.positive(touching.up[1], s2, "G22 at the double root");
  if (first_up && second_up) {
    return signs.positive(p.f1(-1, -1), s1, "f1(--)") ? LeafMode{Leaf::UU1, {0, -1}} : LeafMode{Leaf::UU2, {-1, -1}};
  }
  if (first_up) {
    if (signs.negative(p.f1(1, 1), s1, "f1(++)")) return {Leaf::UD1, {0, 1}};
    return signs.positive(p.f2(1, 1), s2, "f2(++)") ? LeafMode{Leaf::UD2, {1, 1}} : LeafMode{Leaf::UD3, {1, 0}};
  }
  if (!second_up) {
    return signs.negative(p.f2(-1, -1), s2, "f2(--)") ? LeafMode{Leaf::DD1, {-1, -1}} : LeafMode{Leaf::DD2, {-1, 0}};
  }
  signs.fail("G11 and G22 at the double root, which are both positive");
  return {Leaf::DU, {0, 0}};
}

}  // namespace

PlaneDecision decide_exit_fold(const PlaneTable& table) {
  const Plane plane(table);
  const PlaneAlpha root = double_root(plane);
  const auto symmetry = find_symmetry([&](const PlaneSymmetry& s) {
    const Plane p = s.apply(plane);
    if (!(p.h(0) < 0.0 && p.h(1) < 0.0)) return false;
    const Touching touching(p, s.apply(root));
    return touching.curvature[1] < touching.curvature[0];
  });
  PlaneModes admissible;
  for (const PlaneContinuation& mode : admissible_modes(table)) {
    if (mode.mode != PlaneMode{0, 0}) admissible.push(mode);  // what is left of the double root is rounding
  }
  SignTests signs;
  if (!symmetry) {
    signs.fail("common slope of g1 = 0 and g2 = 0 at the double root");
    return conclude(table, Leaf::none, {0, 0}, signs, admissible);
  }
  const Plane canonical = symmetry->apply(plane);
  const auto [s1, s2] = canonical.scale;
  signs.negative(canonical.h(0), s1 * s1, "H1");
  signs.negative(canonical.h(1), s2 * s2, "H2");
  const Touching touching(canonical, symmetry->apply(root));
  signs.positive(touching.curvature[0] - touching.curvature[1],
                 std::max(std::abs(touching.curvature[0]), std::abs(touching.curvature[1])),
                 "difference of the curvatures of g1 = 0 and g2 = 0");
  const LeafMode found = leave_by_fold(canonical, touching, signs);
  return conclude(table, found.leaf, symmetry->apply_inverse(found.mode), signs, admissible);
}

}  // namespace saltus::switching
