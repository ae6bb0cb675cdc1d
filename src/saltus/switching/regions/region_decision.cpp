#include "saltus/switching/regions/region_decision.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "saltus/base/at.hpp"
#include "saltus/switching/table/matrix_stability.hpp"

namespace saltus::switching {
namespace {

/// d psi' / du of the hidden dynamics u_i = psi_i / eps, psi_i = g_r - g_i, i in I but its first, r: G (diag theta -
/// theta theta^T).
bool set_attracts(const RegionRates& rates, const RegionSet& set) {
  const std::size_t m = set.active.size() - 1;
  if (m == 0) return true;
  const auto r = at(set.active[0]);
  const auto g = [&](std::size_t row, std::size_t column) {
    const auto i = at(set.active[row + 1]);
    const auto j = at(set.active[column + 1]);
    return (rates.rate(r, j) - rates.rate(i, j)) - (rates.rate(r, r) - rates.rate(i, r));
  };
  std::vector<double> product(m * m, 0.0);
  for (std::size_t row = 0; row < m; ++row) {
    for (std::size_t column = 0; column < m; ++column) {
      for (std::size_t k = 0; k < m; ++k) {
        const double same = k == column ? set.weights[k + 1] : 0.0;
        product[row * m + column] += g(row, k) * (same - set.weights[k + 1] * set.weights[column + 1]);
      }
    }
  }
  return is_hurwitz(product, static_cast<int>(m));
}

}  // namespace

bool solve_region_set(const RegionRates& rates, const std::vector<int>& active, RegionSet& set) {
  const std::size_t k = active.size();
  std::vector<double> matrix((k + 1) * (k + 1), 0.0);
  std::vector<double> right(k + 1, 0.0);
  double size = 0.0;
  for (const double rate : rates.rates) size = std::max(size, std::abs(rate));
  if (!std::isfinite(size)) return false;
  if (size == 0.0) size = 1.0;
  for (std::size_t row = 0; row < k; ++row) {
    for (std::size_t column = 0; column < k; ++column) {
      matrix[row * (k + 1) + column] = rates.rate(at(active[row]), at(active[column])) / size;
    }
    matrix[row * (k + 1) + k] = -1.0;
    matrix[k * (k + 1) + row] = 1.0;
  }
  right[k] = 1.0;
  LuFactors factors(static_cast<int>(k + 1));
  if (!factors.factor(matrix)) return false;
  factors.solve(right.data());
  set.active = active;
  set.weights.assign(right.begin(), right.end() - 1);
  const double mu = right[k];
  set.margin =
      k > 1 ? *std::min_element(set.weights.begin(), set.weights.end()) : std::numeric_limits<double>::infinity();
  for (int i = 0; i < rates.regions; ++i) {
    if (std::binary_search(active.begin(), active.end(), i)) continue;
    double w = 0.0;
    for (std::size_t column = 0; column < k; ++column) w += rates.rate(at(i), at(active[column])) * set.weights[column];
    set.margin = std::min(set.margin, w / size - mu);
  }
  return std::isfinite(mu) && !std::isnan(set.margin);
}

std::vector<RegionSet> admissible_region_sets(const RegionRates& rates, double tolerance) {
  std::vector<RegionSet> found;
  std::vector<int> active;
  for (std::size_t subset = 1; subset < (std::size_t{1} << at(rates.regions)); ++subset) {
    active.clear();
    for (int i = 0; i < rates.regions; ++i) {
      if ((subset >> at(i) & 1U) != 0) active.push_back(i);
    }
    RegionSet set;
    if (!solve_region_set(rates, active, set) || !(set.margin >= -tolerance)) continue;
    set.attracts = set_attracts(rates, set);
    found.push_back(std::move(set));
  }
  return found;
}

void merge_same_motions(std::vector<RegionSet>& sets) {
  const auto weight = [](const RegionSet& set, int region) {
    const auto place = std::lower_bound(set.active.begin(), set.active.end(), region);
    return place == set.active.end() || *place != region
               ? 0.0
               : set.weights[at(static_cast<int>(place - set.active.begin()))];
  };
  const auto within = [&](const RegionSet& small, const RegionSet& large) {
    if (!small.marginal || !large.marginal || small.active.size() >= large.active.size()) return false;
    const auto& all = large.active;
    const bool part = std::includes(all.begin(), all.end(), small.active.begin(), small.active.end());
    return part && std::all_of(all.begin(), all.end(), [&](int region) {
             return std::abs(weight(small, region) - weight(large, region)) <= 1e-9;  // between 0 and 1
           });
  };
  const auto all = sets;
  std::erase_if(sets, [&](const RegionSet& set) {
    return std::any_of(all.begin(), all.end(), [&](const RegionSet& other) { return within(set, other); });
  });
}

std::size_t preferred_region_set(const std::vector<RegionSet>& sets, const std::vector<int>& before,
                                 const std::vector<double>& weights) {
  const auto continues = [&](const RegionSet& set) {
    if (weights.empty()) return false;
    std::vector<double> change = weights;
    for (std::size_t k = 0; k < set.active.size(); ++k) change[at(set.active[k])] -= set.weights[k];
    // Weights of a mode are known to about 1e-8 where it ends.
    return std::all_of(change.begin(), change.end(), [](double c) { return std::abs(c) <= 1e-6; });
  };
  const auto rank = [&](const RegionSet& set) {
    const auto kept = std::count_if(before.begin(), before.end(), [&](int region) {
      return std::binary_search(set.active.begin(), set.active.end(), region);
    });
    return std::make_tuple(set.attracts, continues(set), kept, set.active.size());
  };
  std::size_t best = 0;
  for (std::size_t i = 1; i < sets.size(); ++i) {
    if (rank(sets[i]) > rank(sets[best])) best = i;
  }
  return best;
}

}  // namespace saltus::switching
