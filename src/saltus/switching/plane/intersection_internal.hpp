// What the decision trees share: from a leaf to a decision.
#pragma once

#include <optional>

#include "saltus/switching/plane/intersection.hpp"
#include "saltus/switching/plane/plane_internal.hpp"
#include "saltus/switching/plane/plane_symmetry_internal.hpp"

namespace saltus::switching {

/// Holds what a tree finds.
struct LeafMode {
  Leaf leaf = Leaf::none;
  PlaneMode mode{};
};

/// Finds the first symmetry for which `canonical(symmetry)` holds.
template <class Canonical>
std::optional<PlaneSymmetry> find_symmetry(Canonical&& canonical) {
  for (unsigned i = 0; i < 8; ++i) {
    const auto symmetry = PlaneSymmetry::number(i);
    if (canonical(symmetry)) return symmetry;
  }
  return std::nullopt;
}

/// Returns admissible_modes() of a table whose plane and roots are known.
[[nodiscard]] PlaneModes admissible_modes(const PlaneTable& table, const Plane& plane, const IntersectionRoots& roots);

/// Returns the selections of a mode, whether or not it is admissible: the sliding ones by their formulas.
[[nodiscard]] PlaneContinuation continuation(const PlaneTable& table, PlaneMode mode);

/// Returns what a leaf decides, in words.
[[nodiscard]] std::string_view reason(Leaf leaf);

/// Returns the decision for `mode`, with all other admissible modes.
[[nodiscard]] PlaneDecision conclude(const PlaneTable& table, Leaf leaf, PlaneMode mode, const SignTests& signs,
                                     const PlaneModes& admissible);

/// Decides where no symmetry brings the situation into canonical form.
[[nodiscard]] PlaneDecision not_canonical(const PlaneTable& table, std::string_view what);

}  // namespace saltus::switching
