#include "saltus/solver/crossover/sides.hpp"

#include <algorithm>
#include <map>

#include "saltus/base/at.hpp"

namespace saltus::solver::crossover {

using mpcc::ActiveSide;

namespace {

/// Sums over the pairs of a group.
struct Sums {
  double G = 0.0;
  double H = 0.0;
};

Sums sums_of(const mpcc::Problem& problem, const std::vector<int>& group, const linalg::Vector& c) {
  Sums sums;
  for (const int pair : group) {
    sums.G += c[problem.constraints() + pair];
    sums.H += c[problem.constraints() + problem.pairs() + pair];
  }
  return sums;
}

}  // namespace

std::vector<std::vector<int>> groups_of(const mpcc::Problem& problem) {
  std::map<int, std::size_t> place;
  std::vector<std::vector<int>> groups;
  for (int pair = 0; pair < problem.pairs(); ++pair) {
    const int group = problem.pair_group(pair);
    if (group < 0) continue;
    const auto [found, is_new] = place.try_emplace(group, groups.size());
    if (is_new) groups.emplace_back();
    groups[found->second].push_back(pair);
  }
  return groups;
}

std::vector<ActiveSide> smaller_sides(const mpcc::Problem& problem, const std::vector<std::vector<int>>& groups,
                                      const linalg::Vector& c) {
  const auto G = c.segment(problem.constraints(), problem.pairs());
  const auto H = c.tail(problem.pairs());
  std::vector<ActiveSide> sides;
  for (int pair = 0; pair < problem.pairs(); ++pair)
    sides.push_back(G[pair] <= H[pair] ? ActiveSide::G : ActiveSide::H);
  for (const auto& group : groups) {
    const auto [sum_G, sum_H] = sums_of(problem, group, c);
    for (const int pair : group) sides[at(pair)] = sum_G <= sum_H ? ActiveSide::G : ActiveSide::H;
  }
  return sides;
}

int undecided_groups(const mpcc::Problem& problem, const std::vector<std::vector<int>>& groups,
                     const linalg::Vector& c) {
  constexpr double undecided = 0.3;
  return static_cast<int>(std::count_if(groups.begin(), groups.end(), [&](const std::vector<int>& group) {
    const auto [sum_G, sum_H] = sums_of(problem, group, c);
    return std::min(sum_G, sum_H) > undecided * std::max(sum_G, sum_H);
  }));
}

}  // namespace saltus::solver::crossover
