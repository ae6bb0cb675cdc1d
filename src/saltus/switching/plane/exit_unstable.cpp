// Sliding on the intersection ends because no scaling makes its root stable any more: Figs. 9 and 10 of
// [guglielmi2022].
#include "saltus/switching/plane/intersection.hpp"
#include "saltus/switching/plane/intersection_internal.hpp"
#include "saltus/switching/plane/spiral.hpp"

namespace saltus::switching {
namespace {

struct Loss {
  Leaf leaf = Leaf::none;
  PlaneMode mode{};
  std::optional<PlaneMode> second;  ///< the other limit
};

/// In canonical form: G11 = 0 < G22, G12 > 0, f_1^{--} < 0 < f_1^{-+}: g_1 = A(alpha_1) (alpha_2 - alpha_2*).
Loss lose_stability(const Plane& p, SignTests& signs) {
  const auto [s1, s2] = p.scale;
  const double f1_mm = p.f1(-1, -1);
  const double f1_mp = p.f1(-1, 1);
  const double f1_pp = p.f1(1, 1);
  const double f2_mm = p.f2(-1, -1);
  const bool up_left = signs.positive(f2_mm, s2, "f2(--)");
  if (signs.positive(f1_pp, s1, "f1(++)")) {
    const bool up_right = signs.positive(p.f2(1, 1), s2, "f2(++)");
    if (up_left) return up_right ? Loss{Leaf::C9_2, {1, 1}, {}} : Loss{Leaf::C9_1, {}, {}};
    if (!up_right) return {Leaf::C9_3, {-1, -1}, {}};
    // Either region attracts from half of the neighbourhood: into the faster one, which does not depend on labels.
    if (p.f2(1, 1) >= -f2_mm) return {Leaf::C9_4, {1, 1}, PlaneMode{-1, -1}};
    return {Leaf::C9_4, {-1, -1}, PlaneMode{1, 1}};
  }
  // The zero of A, at which g_1 = 0 has its other branch: f_1^{-+} : f_1^{++} = A(0) : A(1).
  const double asymptote = sliding_alpha(f1_mp, f1_pp);
  const Bilinear g2 = p.g(1);
  static_cast<void>(f1_mm);
  if (signs.positive(g2({asymptote, 1.0}), s2, "g2 at the upper end of the asymptote of g1 = 0")) {
    if (up_left) return {Leaf::C10_2, {0, 1}, {}};
    return {Leaf::C10_4, {0, 1}, PlaneMode{-1, -1}};
  }
  if (up_left) return {Leaf::C10_1, {1, -1}, {}};
  return {Leaf::C10_3, {-1, -1}, {}};
}

/// Which diagonal element vanishes: the smaller one.
bool is_canonical(const Plane& p, const SlidingRoot& root) {
  const auto& g = root.sliding_jacobian;
  const bool first_vanishes = std::abs(g[0][0]) * p.scale[1] < std::abs(g[1][1]) * p.scale[0];
  return first_vanishes && g[1][1] > 0.0 && g[0][1] > 0.0 && p.f1(-1, -1) < 0.0 && p.f1(-1, 1) > 0.0;
}

/// The region in which a spiral begins does not matter: one of a family.
PlaneDecision spirals(const PlaneTable& table, const SignTests& signs, const PlaneModes& admissible) {
  PlaneDecision decision = conclude(table, Leaf::C9_1, {-1, -1}, signs, admissible);
  decision.spirals_out = decision.ambiguous = true;
  return decision;
}

}  // namespace

PlaneDecision decide_exit_unstable(const PlaneTable& table) {
  const Plane plane(table);
  const IntersectionRoots roots = intersection_roots(plane);
  const auto& root = roots.rising;
  if (!root) return not_canonical(table, "sliding root on the intersection");
  const auto symmetry =
      find_symmetry([&](const PlaneSymmetry& s) { return is_canonical(s.apply(plane), s.apply(*root)); });
  if (!symmetry) return not_canonical(table, "the diagonal elements of G at the sliding root");
  const Plane canonical = symmetry->apply(plane);
  SignTests signs;
  const SlidingRoot image = symmetry->apply(*root);
  const auto [s1, s2] = canonical.scale;
  signs.positive(image.sliding_jacobian[1][1], s2, "G22 at the sliding root");
  signs.positive(image.sliding_jacobian[0][1], s1, "G12 at the sliding root");
  const Loss loss = lose_stability(canonical, signs);
  const PlaneModes admissible = admissible_modes(table, plane, roots);
  if (loss.leaf == Leaf::C9_1) return spirals(table, signs, admissible);
  PlaneDecision decision = conclude(table, loss.leaf, symmetry->apply_inverse(loss.mode), signs, admissible);
  // Fig. 10: during the turns around the root the solution comes close to the asymptote; for a large ratio of scalings
  // it leaks through the gap that has opened, so that only the first picture is the same for all.
  decision.by_scaling = loss.leaf == Leaf::C10_2 || loss.leaf == Leaf::C10_3 || loss.leaf == Leaf::C10_4;
  decision.ambiguous = decision.by_scaling || loss.second.has_value();
  return decision;
}

}  // namespace saltus::switching
