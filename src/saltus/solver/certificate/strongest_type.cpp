#include "saltus/solver/certificate/strongest_type.hpp"

#include <limits>
#include <optional>
#include <utility>
#include <vector>

namespace saltus::solver::certificate {
namespace {

using result::StationarityType;

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr int most_programs = 500;

struct Range {
  double lower, upper;
};

/// What the two multipliers of a pair may be, one way or another.
std::vector<std::pair<Range, Range>> ways_of(StationarityType type, double zero) {
  const Range any{-infinite, infinite}, positive{-zero, infinite}, negative{-infinite, zero}, none{-zero, zero};
  switch (type) {
    case StationarityType::S:
      return {{positive, positive}};
    case StationarityType::M:
      return {{positive, positive}, {none, any}, {any, none}};
    case StationarityType::C:
      return {{positive, positive}, {negative, negative}};
    case StationarityType::A:
      return {{positive, any}, {any, positive}};
    case StationarityType::W:
      return {{any, any}};
  }
  __builtin_unreachable();
}

/// Decides pair by pair; where no multipliers are left it goes back.
class TypeSearch {
 public:
  TypeSearch(const MultiplierSet& set, std::vector<std::pair<SideMultiplier, SideMultiplier>> pairs, double zero,
             LpccSolver& linear)
      : set_(set), pairs_(std::move(pairs)), zero_(zero), linear_(linear) {
    for (const auto& [G, H] : pairs_) freed_.insert(freed_.end(), {G.owner, H.owner});
  }

  [[nodiscard]] bool allows(StationarityType type) {
    conditions_.clear();
    return decide(ways_of(type, zero_), 0);
  }

 private:
  // NOLINTNEXTLINE(misc-no-recursion): as deep as there are pairs
  bool decide(const std::vector<std::pair<Range, Range>>& ways, std::size_t pair) {
    if (pair == pairs_.size()) return true;
    const auto& [G, H] = pairs_[pair];
    for (const auto& [of_G, of_H] : ways) {
      if (++programs_ > most_programs) return false;
      conditions_.push_back({&G, of_G.lower, of_G.upper});
      conditions_.push_back({&H, of_H.lower, of_H.upper});
      if (set_.can_have(conditions_, freed_, linear_) && decide(ways, pair + 1)) return true;
      conditions_.resize(conditions_.size() - 2);
    }
    return false;
  }

  const MultiplierSet& set_;
  std::vector<std::pair<SideMultiplier, SideMultiplier>> pairs_;
  double zero_;
  LpccSolver& linear_;
  std::vector<int> freed_;
  std::vector<MultiplierCondition> conditions_;
  int programs_ = 0;
};

}  // namespace

StationarityType strongest_type(mpcc::Problem& problem, const MultiplierSet& set, const std::vector<bool>& biactive,
                                StationarityType found, double zero, LpccSolver& linear) {
  std::vector<std::pair<SideMultiplier, SideMultiplier>> pairs;
  for (int pair = 0; pair < problem.pairs(); ++pair) {
    if (!biactive[static_cast<std::size_t>(pair)]) continue;
    auto G = set.of_side(problem, problem.constraints() + pair);
    auto H = set.of_side(problem, problem.constraints() + problem.pairs() + pair);
    if (!G || !H) return found;
    pairs.emplace_back(std::move(*G), std::move(*H));
  }
  TypeSearch search(set, std::move(pairs), zero, linear);
  for (const auto type : {StationarityType::S, StationarityType::M, StationarityType::C, StationarityType::A}) {
    if (type == found || search.allows(type)) return type;
  }
  return found;
}

}  // namespace saltus::solver::certificate
