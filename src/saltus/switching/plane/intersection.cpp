#include "saltus/switching/plane/intersection.hpp"

#include <array>

#include "saltus/switching/plane/intersection_internal.hpp"

namespace saltus::switching {
namespace {

struct LeafText {
  Leaf leaf;
  std::string_view name, reason;
};

// "The surface slid on" is the one of the mode before, "the surface reached" the other.
constexpr std::array leaf_texts{
    LeafText{Leaf::none, "", "no decision tree applies"},
    LeafText{Leaf::E1, "E1", "sliding on the intersection: its root is approached directly"},
    LeafText{Leaf::E2, "E2", "sliding on the intersection: the hidden dynamics turns about its root"},
    LeafText{Leaf::E3, "E3", "no sliding on the intersection: sliding goes on across the surface reached"},
    LeafText{Leaf::E4, "E4", "no sliding on the intersection: both surfaces are left"},
    LeafText{Leaf::E5, "E5", "no sliding on the intersection: sliding changes over to the surface reached"},
    LeafText{Leaf::E6, "E6", "no sliding on the intersection: sliding goes on across the surface reached"},
    LeafText{Leaf::E7, "E7", "no sliding on the intersection: both surfaces are left"},
    LeafText{Leaf::E8, "E8", "sliding on the intersection: its root is approached directly"},
    LeafText{Leaf::E9, "E9", "sliding on the intersection: the hidden dynamics cannot leave the square"},
    LeafText{Leaf::E10, "E10", "sliding on the intersection or leaving both surfaces"},
    LeafText{Leaf::E11, "E11", "sliding on the intersection: the hidden dynamics cannot leave the square"},
    LeafText{Leaf::E12, "E12", "sliding on the intersection or across the surface reached"},
    LeafText{Leaf::A1, "A1", "a selection leaves [0, 1], the other one still attracts: sliding on its surface"},
    LeafText{Leaf::A2, "A2", "a selection leaves [0, 1], the other one repels: both surfaces are left"},
    LeafText{Leaf::A3, "A3", "a selection leaves [0, 1], the other one repels: both surfaces are left"},
    LeafText{Leaf::UU1, "UU1", "the sliding roots vanish: sliding goes on along one surface"},
    LeafText{Leaf::UU2, "UU2", "the sliding roots vanish: both surfaces are left"},
    LeafText{Leaf::UD1, "UD1", "the sliding roots vanish: sliding goes on along one surface"},
    LeafText{Leaf::UD2, "UD2", "the sliding roots vanish: both surfaces are left"},
    LeafText{Leaf::UD3, "UD3", "the sliding roots vanish: sliding goes on along one surface"},
    LeafText{Leaf::DD1, "DD1", "the sliding roots vanish: both surfaces are left"},
    LeafText{Leaf::DD2, "DD2", "the sliding roots vanish: sliding goes on along one surface"},
    LeafText{Leaf::DU, "DU", "roots that vanish were unstable for every scaling"},
    LeafText{Leaf::C9_1, "C9-1", "the sliding root became unstable for every scaling: the solution spirals out"},
    LeafText{Leaf::C9_2, "C9-2", "the sliding root became unstable for every scaling: both surfaces are left"},
    LeafText{Leaf::C9_3, "C9-3", "the sliding root became unstable for every scaling: both surfaces are left"},
    LeafText{Leaf::C9_4, "C9-4", "the sliding root became unstable for every scaling: one of two regions"},
    LeafText{Leaf::C10_1, "C10-1", "the sliding root became unstable for every scaling: both surfaces are left"},
    LeafText{Leaf::C10_2, "C10-2",
             "the sliding root became unstable for every scaling: sliding goes on along one surface"},
    LeafText{Leaf::C10_3, "C10-3", "the sliding root became unstable for every scaling: both surfaces are left"},
    LeafText{Leaf::C10_4, "C10-4",
             "the sliding root became unstable for every scaling: sliding on one surface or a region"},
    LeafText{Leaf::K1, "K1", "both selections leave [0, 1] together: both surfaces are left"},
    LeafText{Leaf::K2, "K2", "both selections leave [0, 1] together: sliding goes on along one surface"},
    LeafText{Leaf::K3, "K3",
             "both selections leave [0, 1] together, one comes back and repels: both surfaces are left"},
    LeafText{Leaf::P1, "P1", "both surfaces are reached at once: the same mode follows, whichever is taken first"},
    LeafText{Leaf::P2, "P2", "both surfaces are reached at once: the mode behind depends on which is taken first"},
    LeafText{Leaf::S1, "S1", "start on the intersection: the only admissible mode"},
    LeafText{Leaf::S2, "S2", "start on the intersection: the only admissible mode that attracts"},
    LeafText{Leaf::S3, "S3", "start on the intersection: several modes attract"},
    LeafText{Leaf::spiral_in, "spiral-in", "a spiral shrinks to the intersection: sliding on it"},
    LeafText{Leaf::spiral_out, "spiral-out", "a spiral leaves the intersection"},
};

constexpr bool in_order() {
  for (std::size_t i = 0; i < leaf_texts.size(); ++i) {
    if (leaf_texts[i].leaf != static_cast<Leaf>(i)) return false;
  }
  return true;
}
static_assert(in_order() && leaf_texts.size() == static_cast<std::size_t>(Leaf::spiral_out) + 1);

const LeafText& text_of(Leaf leaf) { return leaf_texts[static_cast<std::size_t>(leaf)]; }

}  // namespace

std::string_view name(Leaf leaf) { return text_of(leaf).name; }
std::string_view reason(Leaf leaf) { return text_of(leaf).reason; }

PlaneContinuation continuation(const PlaneTable& table, PlaneMode mode) {
  PlaneContinuation result{mode, {mode[0] > 0 ? 1.0 : 0.0, mode[1] > 0 ? 1.0 : 0.0}, true};
  if (mode == PlaneMode{0, 0}) {
    if (const auto root = intersection_roots(Plane(table)).rising) result.alpha = root->alpha;
    return result;
  }
  for (std::size_t j = 0; j < 2; ++j) {
    if (mode[j] != 0) continue;
    const std::size_t base = mode[1 - j] > 0 ? std::size_t{1} << (1 - j) : 0;
    const double below = table.velocity(j, base);
    const double above = table.velocity(j, base | std::size_t{1} << j);
    if (below != above) result.alpha[j] = sliding_alpha(below, above);
  }
  return result;
}

PlaneDecision conclude(const PlaneTable& table, Leaf leaf, PlaneMode mode, const SignTests& signs,
                       const PlaneModes& admissible) {
  PlaneDecision decision;
  decision.leaf = leaf;
  decision.reason = text_of(leaf).reason;
  decision.undecided = signs.undecided();
  const PlaneContinuation* chosen = nullptr;
  for (const PlaneContinuation& candidate : admissible) {
    if (chosen == nullptr && candidate.mode == mode) {
      chosen = &candidate;  // of two roots the first, det G > 0
    } else {
      decision.others.push(candidate);
    }
  }
  decision.chosen = chosen != nullptr ? *chosen : continuation(table, mode);
  return decision;
}

PlaneDecision not_canonical(const PlaneTable& table, std::string_view what) {
  SignTests signs;
  signs.fail(what);
  PlaneDecision decision = conclude(table, Leaf::none, {0, 0}, signs, admissible_modes(table));
  return decision;
}

}  // namespace saltus::switching
