// Which side of each pair a branch problem fixes, and what pairs have to be decided together.
#pragma once

#include <vector>

#include "saltus/mpcc/problem.hpp"

namespace saltus::solver::crossover {

/// Returns pairs whose zero side is the same (mpcc::Problem::pair_group), without those of group -1.
[[nodiscard]] std::vector<std::vector<int>> groups_of(const mpcc::Problem& problem);

/// Chooses of each group the side whose sum is smaller: G or H, one per pair. A threshold in the values of single pairs
/// does not tell: near the ends of an element both are small. Pairs of group -1 have their own smaller side.
/// @param c  values of (g, G, H)
[[nodiscard]] std::vector<mpcc::ActiveSide> smaller_sides(const mpcc::Problem& problem,
                                                          const std::vector<std::vector<int>>& groups,
                                                          const linalg::Vector& c);

/// Returns how many groups could go to either side: min(sum G, sum H) > 0.3 max. Without any, the branch of the smaller
/// sides is the one that the relaxed problems lead to.
/// @param c  values of (g, G, H)
[[nodiscard]] int undecided_groups(const mpcc::Problem& problem, const std::vector<std::vector<int>>& groups,
                                   const linalg::Vector& c);

}  // namespace saltus::solver::crossover
