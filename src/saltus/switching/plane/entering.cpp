// From sliding on one surface into the intersection: Figs. 5 and 6 of [guglielmi2022].
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "saltus/switching/plane/intersection.hpp"
#include "saltus/switching/plane/intersection_internal.hpp"

namespace saltus::switching {
namespace {

/// What the tree finds: sliding on the intersection, or the way out, or both.
struct Entry {
  Leaf leaf = Leaf::none;
  PlaneMode mode{};               ///< under weight on the surface that was slid on
  std::optional<PlaneMode> exit;  ///< the other limit, in the ambiguous leaves
  bool exit_for_passive = false;  ///< whether any scaling leads there
};

/// The root on the branch of g_1 = 0 through the point of entry, the one that is met first. Being on that branch is
/// G11 < 0, which makes (4.12) hold: with the smallest alpha_2 the determinant is positive.
std::optional<SlidingRoot> root_on_branch(const Plane& plane, const IntersectionRoots& roots, SignTests& signs) {
  if (std::abs(roots.discriminant) <= sign_tolerance && roots.rising) {
    if (roots.rising->inside()) signs.fail("discriminant of the sliding roots");
  }
  std::optional<SlidingRoot> first;
  for (const auto& root : {roots.rising, roots.falling}) {
    if (!root) continue;
    const auto [x, y] = root->alpha;
    const double margin = std::min(std::min(x, 1.0 - x), std::min(y, 1.0 - y));
    if (margin < -sign_tolerance) continue;
    if (signs.negative(margin, 1.0, "distance of a sliding root from the edge of the square")) continue;
    if (!signs.negative(root->sliding_jacobian[0][0], plane.scale[0], "G11 at a sliding root")) continue;
    if (!first || y < first->alpha[1]) first = root;
  }
  return first;
}

/// In canonical form: from (0, -1), f_1^{--} > 0 > f_1^{+-}, f_2^{--} > 0, and H_1 > 0 or f_2^{+-} < 0.
Entry enter(const Plane& p, const IntersectionRoots& roots, SignTests& signs) {
  const auto [s1, s2] = p.scale;
  const auto root = root_on_branch(p, roots, signs);
  const double f1_mp = p.f1(-1, 1);
  const double f1_pp = p.f1(1, 1);
  const bool left_turning = signs.positive(p.h(0), s1 * s1, "H1 = f1(-+) f1(+-) - f1(++) f1(--)");
  double right_edge = 0.0;  // g_2(1, alpha_2*)
  if (root) right_edge = (1.0 - root->alpha[1]) * p.f2(1, -1) + root->alpha[1] * p.f2(1, 1);
  if (left_turning) {
    if (root) return {right_edge < 0.0 ? Leaf::E1 : Leaf::E2, {0, 0}, {}, false};
    if (signs.positive(f1_mp, s1, "f1(-+)")) return {Leaf::E3, {0, 1}, {}, false};
    if (signs.positive(p.f2(-1, 1), s2, "f2(-+)")) return {Leaf::E4, {-1, 1}, {}, false};
    return {Leaf::E5, {-1, 0}, {}, false};
  }
  if (!root) {
    if (signs.negative(f1_pp, s1, "f1(++)")) return {Leaf::E6, {0, 1}, {}, false};
    return {Leaf::E7, {1, 1}, {}, false};
  }
  if (signs.positive(right_edge, s2, "g2(1, alpha2) at the sliding root")) return {Leaf::E8, {0, 0}, {}, false};
  // Whether the solution can escape for any scaling: when psi_2 moves infinitely fast.
  const Bilinear g2 = p.g(1);
  const double entry = sliding_alpha(p.f1(-1, -1), p.f1(1, -1));
  const bool passes = g2({entry, 1.0}) > 0.0 || root->sliding_jacobian[1][1] > 0.0;
  if (signs.positive(f1_pp, s1, "f1(++)")) {
    if (signs.negative(p.f2(1, 1), s2, "f2(++)")) return {Leaf::E9, {0, 0}, {}, false};
    return {Leaf::E10, {0, 0}, PlaneMode{1, 1}, passes};
  }
  const double top = sliding_alpha(f1_mp, f1_pp);
  if (signs.negative(g2({top, 1.0}), s2, "g2 at the upper end of g1 = 0")) return {Leaf::E11, {0, 0}, {}, false};
  return {Leaf::E12, {0, 0}, PlaneMode{0, 1}, passes};
}

}  // namespace

// g_2 has one sign in the square and no root: of the two reflections of the surface slid on that with H_1 > 0 ends in
// E3, and no other mode is admissible.
std::optional<PlaneContinuation> pass_across(const PlaneTable& table, PlaneMode incoming) {
  const std::size_t slid = incoming[0] == 0 ? 0 : 1;
  const std::size_t reached = 1 - slid;
  if (incoming[slid] != 0 || incoming[reached] == 0) return std::nullopt;
  const std::size_t across = std::size_t{1} << slid;
  const std::size_t behind = std::size_t{1} << reached;
  const auto& f1 = table.sides[slid];
  const auto& f2 = table.sides[reached];
  double s1 = 0.0, s2 = 0.0;
  for (std::size_t corner = 0; corner < 4; ++corner) {
    s1 = std::max(s1, std::abs(f1[corner].velocity));
    s2 = std::max(s2, std::abs(f2[corner].velocity));
  }
  // Products neither over- nor underflow, and what is tested below is far from every tolerance of the tree.
  constexpr double largest = 1e100;
  constexpr double clear = 1e-4;
  if (!(std::max(s1, s2) < largest && std::min(s1, s2) > 1.0 / largest)) return std::nullopt;
  for (std::size_t corner = 0; corner < 4; ++corner) {
    const double inward = (corner & across) != 0 ? -f1[corner].velocity : f1[corner].velocity;
    if (!(inward > clear * s1 && -incoming[reached] * f2[corner].velocity > clear * s2)) return std::nullopt;
  }
  const double h = f1[behind].velocity * f1[across].velocity - f1[across | behind].velocity * f1[0].velocity;
  if (!(std::abs(h) > clear * s1 * s1)) return std::nullopt;
  PlaneContinuation behind_it;
  const std::size_t far = incoming[reached] < 0 ? behind : 0;
  behind_it.mode[reached] = -incoming[reached];
  behind_it.alpha[slid] = sliding_alpha(f1[far].velocity, f1[far | across].velocity);
  behind_it.alpha[reached] = incoming[reached] < 0 ? 1.0 : 0.0;
  behind_it.attracts = true;
  return behind_it;
}

std::string_view reason_of_passage() { return reason(Leaf::E3); }

PlaneDecision decide_entering(const PlaneTable& table, PlaneMode incoming, SelectionPolicy policy) {
  if (const auto passage = pass_across(table, incoming)) {
    PlaneDecision decision;
    decision.leaf = Leaf::E3;
    decision.reason = reason_of_passage();
    decision.chosen = *passage;
    return decision;
  }
  const Plane plane(table);
  const auto symmetry = find_symmetry([&](const PlaneSymmetry& s) {
    if (s.apply(incoming) != PlaneMode{0, -1}) return false;
    const Plane p = s.apply(plane);
    return p.f2(-1, -1) > 0.0 && (p.h(0) > 0.0 || p.f2(1, -1) <= 0.0);
  });
  if (!symmetry) return not_canonical(table, "velocity of the sliding solution towards the second surface");
  const Plane canonical = symmetry->apply(plane);
  const auto [s1, s2] = canonical.scale;
  SignTests signs;
  const double f1_mm = canonical.f1(-1, -1);
  const double f1_pm = canonical.f1(1, -1);
  signs.positive(f1_mm, s1, "f1(--), which holds the solution on the surface it slides on");
  signs.negative(f1_pm, s1, "f1(+-), which holds the solution on the surface it slides on");
  if (!signs.positive(f1_mm * canonical.f2(1, -1) - f1_pm * canonical.f2(-1, -1), s1 * s2,
                      "velocity of the sliding solution towards the second surface")) {
    return not_canonical(table, "velocity of the sliding solution towards the second surface");
  }
  const IntersectionRoots roots = intersection_roots(plane);
  IntersectionRoots images = roots;
  for (auto* root : {&images.rising, &images.falling}) {
    if (*root) *root = symmetry->apply(**root);
  }
  const Entry entry = enter(canonical, images, signs);
  const bool passive = entry.exit_for_passive && policy == SelectionPolicy::passive_dominant;
  PlaneDecision decision = conclude(table, entry.leaf, symmetry->apply_inverse(passive ? *entry.exit : entry.mode),
                                    signs, admissible_modes(table, plane, roots));
  decision.ambiguous = decision.by_scaling = entry.exit_for_passive;
  return decision;
}

}  // namespace saltus::switching
