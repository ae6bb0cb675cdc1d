// Regions by indicator (Stewart's form): which of those that meet at a point stay at the common minimum.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace saltus::switching {

/// Holds n regions with equal indicators g_i at a point, and their fields f_j:
///   rates[i n + j] = w_ij = d/dt g_i along f_j, up to a constant per column j.
struct RegionRates {
  int regions = 0;
  std::vector<double> rates;
  [[nodiscard]] double rate(std::size_t i, std::size_t j) const {
    return rates[i * static_cast<std::size_t>(regions) + j];
  }
};

/// Holds a set of regions I that moves on with equal, and smallest, indicators: a solution of Stewart's linear
/// complementarity system ([stewart1990])
///   theta >= 0, sum_i theta_i = 1,   w_i = sum_j w_ij theta_j >= mu,   theta_i (w_i - mu) = 0.
struct RegionSet {
  std::vector<int> active;      ///< I, ascending
  std::vector<double> weights;  ///< theta_i of I
  /// Whether the weights return to theta after a small disturbance where they follow the indicators by
  /// theta_i ~ exp(-g_i / eps): eigenvalues of a matrix of order |I| - 1.
  bool attracts = true;
  /// The smallest of theta_i over I and (w_i - mu) / max |w_ij| elsewhere: within rounding of 0 the set is only
  /// admissible if both grow along its own motion.
  double margin = 0.0;
  bool marginal = false;  ///< it is within rounding of 0, and stays there: for who looks along the motion to set
};

/// Finds the weights of the set `active` (ascending) as they solve the equalities, admissible or not; nothing if they
/// are not determined. Cost: an elimination of order |I| + 1.
[[nodiscard]] bool solve_region_set(const RegionRates& rates, const std::vector<int>& active, RegionSet& set);

/// Returns all sets whose margin is at least -tolerance, of the 2^n - 1 that solve_point tries; n <= 12.
[[nodiscard]] std::vector<RegionSet> admissible_region_sets(const RegionRates& rates, double tolerance);

/// Lets the largest one of marginal sets that move alike, with the same weights, stand for all. At an equilibrium of
/// one of the fields the indicators of all regions stay equal.
void merge_same_motions(std::vector<RegionSet>& sets);

/// Decides which of several sets to go on with. A set comes before another one for the first of these that tells them
/// apart:
/// - it attracts;
/// - it has the weights of before (n of them, or none);
/// - it has more regions of `before`;
/// - it is larger;
/// - it is listed first.
[[nodiscard]] std::size_t preferred_region_set(const std::vector<RegionSet>& sets, const std::vector<int>& before,
                                               const std::vector<double>& weights = {});

}  // namespace saltus::switching
