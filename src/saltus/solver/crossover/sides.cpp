#include "saltus/solver/crossover/sides.hpp"

#include <map>

#include "saltus/base/at.hpp"

namespace saltus::solver::crossover {

using mpcc::ActiveSide;

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
    double sum_G = 0.0;
    double sum_H = 0.0;
    for (const int pair : group) {
      sum_G += G[pair];
      sum_H += H[pair];
    }
    for (const int pair : group) sides[at(pair)] = sum_G <= sum_H ? ActiveSide::G : ActiveSide::H;
  }
  return sides;
}

}  // namespace saltus::solver::crossover
