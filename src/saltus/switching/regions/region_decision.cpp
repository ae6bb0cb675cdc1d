#include "saltus/switching/regions/region_decision.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <tuple>
#include <utility>

#include "saltus/base/at.hpp"
#include "saltus/switching/point/point_solver.hpp"
#include "saltus/switching/table/matrix_stability.hpp"

namespace saltus::switching {
namespace {

/// Stewart's system as a problem of complementarity: theta in half lines with w - mu, and mu free, with sum theta - 1.
struct StewartSystem {
  explicit StewartSystem(const RegionRates& rates)
      : effects(linalg::Matrix::zero(rates.regions + 1, rates.regions + 1)),
        constant(-linalg::Vector::unit(rates.regions + 1, rates.regions)),
        problem{{}, effects, constant, 1.0} {
    const int n = rates.regions;
    double size = 0.0;
    for (const double rate : rates.rates) size = std::max(size, std::abs(rate));
    for (int i = 0; i < n; ++i) {
      problem.blocks.push_back({.kind = Block::Kind::half_line, .row = i});
      for (int j = 0; j < n; ++j) effects(i, j) = rates.rate(at(i), at(j)) / (size == 0.0 ? 1.0 : size);
      effects(i, n) = -1.0;
      effects(n, i) = 1.0;
    }
    problem.blocks.push_back({.kind = Block::Kind::free, .row = n});
  }
  linalg::Matrix effects;
  linalg::Vector constant;
  PointProblem problem;
};

/// Nothing where the weights are not determined.
std::optional<RegionSet> set_of(const PointSolution& solution) {
  if (solution.is_open || !solution.idle.empty() || !solution.y.all_finite()) return std::nullopt;
  RegionSet set;
  set.margin = std::numeric_limits<double>::infinity();
  for (linalg::Index i = 0; i + 1 < solution.z.size(); ++i) {
    const bool is_active = solution.faces[at(i)] == Face::closed;
    if (!is_active) set.margin = std::min(set.margin, solution.y(i));
    if (!is_active) continue;
    set.active.push_back(static_cast<int>(i));
    set.weights.push_back(solution.z(i));
  }
  if (set.active.size() > 1)
    set.margin = std::min(set.margin, *std::min_element(set.weights.begin(), set.weights.end()));
  return set;
}

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
  const StewartSystem system(rates);
  std::vector<Face> faces(system.problem.blocks.size(), Face::open);
  for (const int i : active) faces[at(i)] = Face::closed;
  faces.back() = Face::inside;
  HeldRows rows(system.problem.constant.size());
  PointSolution solution;
  if (!system.effects.all_finite() || !solve_least(system.problem, faces, rows, solution)) return false;
  auto found = set_of(solution);
  if (found) set = std::move(*found);
  return found.has_value();
}

std::vector<RegionSet> admissible_region_sets(const RegionRates& rates, double tolerance) {
  const StewartSystem system(rates);
  if (!system.effects.all_finite()) return {};
  std::vector<RegionSet> found;
  for (const auto& solution : solve_point(system.problem, {.holds = -tolerance}).all) {
    auto set = set_of(solution);
    if (!set || !(set->margin >= -tolerance)) continue;
    set->attracts = set_attracts(rates, *set);
    found.push_back(std::move(*set));
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
