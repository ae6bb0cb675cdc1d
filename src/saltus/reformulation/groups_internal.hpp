// f as a sum of parts with disjoint selections, and the regions of each part.
#pragma once

#include <vector>

#include "saltus/linalg/int_matrix.hpp"
#include "saltus/reformulation/unnesting_internal.hpp"

namespace saltus::reformulation {

/// Holds a term of the sum that one component of f is.
struct FieldTerm {
  int state = 0;
  SXElem value;
  std::vector<int> surfaces;  ///< whose alpha occurs in it, ascending
};

/// Holds selections that occur in common products, and the terms of f they are in.
struct FieldGroup {
  std::vector<int> surfaces;         ///< ascending
  std::vector<int> indicator_parts;  ///< ascending
  std::vector<FieldTerm> terms;      ///< none where no selection of the group is in f
};

struct FieldGroups {
  std::vector<SXElem> constant;    ///< n_x: what no selection is in
  std::vector<FieldGroup> groups;  ///< in the order of their first selection, surfaces before indicators; all of them
};

/// Finds the finest split of f into sums of terms that have no selection in common, by structure: products are
/// multiplied out where only one factor has selections.
[[nodiscard]] FieldGroups additive_groups(const Unnested& unnested);

/// Most switching functions in a group that is written by the fields of its regions (2^10 of them).
inline constexpr int most_surfaces = 10;

/// Holds the regions a group's part of f tells apart: rows of a sign matrix, 0 where a switching function does not
/// matter, and the number of the field in each. Rows with the same field are a union.
struct GroupRegions {
  linalg::IntMatrix signs;    ///< columns: the group's surfaces
  std::vector<int> field_of;  ///< per row: index into fields
  std::vector<SX> fields;     ///< n_x each
};
/// Finds regions of groups of at most most_surfaces surfaces without indicators.
[[nodiscard]] GroupRegions regions_of(const FieldGroup& group, const Unnested& unnested, const model::System& system);

/// Returns a term's values where each of its surfaces has the side of a corner: bit k of the position is alpha of
/// term.surfaces[k].
[[nodiscard]] std::vector<SXElem> corner_values(const FieldTerm& term, const Unnested& unnested);

}  // namespace saltus::reformulation
