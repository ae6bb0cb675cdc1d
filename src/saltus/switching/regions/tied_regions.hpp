// Regions by indicator that meet where their indicators depend on each other: which of them go on together.
#pragma once

#include <vector>

#include "saltus/linalg/matrix.hpp"
#include "saltus/switching/regions/region_decision.hpp"
#include "saltus/switching/regions/region_polytope.hpp"

namespace saltus::switching {

/// Holds regions that meet, with g_r - g_i = sum_k y_ik s_k, and how their fields move them.
struct RegionTie {
  RegionPolytope polytope;  ///< the y_i
  linalg::Matrix rates;     ///< m x n: ds/dt along the field of each region
};

/// Finds the set of regions of a face, the largest sums y_i . ds/dt being theirs, with the weights of RegionWeights.
/// @param near  weights of the regions of the face, in their order, to start from
/// @return false if there are no such weights near by
[[nodiscard]] bool solve_region_face(const RegionTie& tie, const std::vector<int>& active,
                                     const std::vector<double>& near, RegionSet& set);

/// Returns all sets of regions that go on together: those of a face of the polytope (others do not meet near by), with
/// positive weights, and with indicators that stay below those of the others. Margins and weights as of
/// admissible_region_sets(), whose sets these are where the y_i are independent; of a face the margin looks at the sum
/// of the weights off each of its facets. Cost: a Newton iteration from 2 n + 1 starts for each face that is not a
/// simplex, one linear system for each that is. LIMIT: roots that none of these starts leads to are not found;
/// parallelograms have at most two.
[[nodiscard]] std::vector<RegionSet> admissible_region_faces(const RegionTie& tie, double tolerance);

/// Returns whether some weights of all regions together keep their indicators equal: 0 is a convex combination of the
/// rates, of m + 1 of them then (Caratheodory). The weights of RegionWeights need not be among these. Cost: binomial(n,
/// m + 1) linear systems.
[[nodiscard]] bool can_be_held(const RegionTie& tie);

/// Returns whether the motion of a set depends on which of all weights with the same ds/dt are taken: then Stewart's
/// system has solutions that move differently.
/// @param fields  n_x x n, in the order of the tie
[[nodiscard]] bool motion_depends_on_weights(const RegionTie& tie, const RegionSet& set, const linalg::Matrix& fields);

}  // namespace saltus::switching
