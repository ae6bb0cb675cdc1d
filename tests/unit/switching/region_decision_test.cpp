// Stewart's complementarity system: every set that is found solves it, and monotone ones have one solution.
#include "saltus/switching/regions/region_decision.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace saltus::switching {
namespace {

RegionRates random_rates(int n, std::mt19937& random) {
  std::uniform_real_distribution<double> entry(-1.0, 1.0);
  RegionRates rates{n, std::vector<double>(static_cast<std::size_t>(n * n))};
  for (double& rate : rates.rates) rate = entry(random);
  return rates;
}

/// Checks the conditions in words that share nothing with the solver.
void expect_solves(const RegionRates& rates, const RegionSet& set) {
  const auto n = static_cast<std::size_t>(rates.regions);
  std::vector<double> theta(n, 0.0), w(n, 0.0);
  for (std::size_t k = 0; k < set.active.size(); ++k) theta[static_cast<std::size_t>(set.active[k])] = set.weights[k];
  double sum = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    sum += theta[i];
    for (std::size_t j = 0; j < n; ++j) w[i] += rates.rates[i * n + j] * theta[j];
  }
  EXPECT_NEAR(sum, 1.0, 1e-12);
  const double mu = *std::min_element(w.begin(), w.end());
  for (std::size_t i = 0; i < n; ++i) {
    EXPECT_GE(theta[i], 0.0);
    EXPECT_NEAR(theta[i] * (w[i] - mu), 0.0, 1e-9);
  }
}

TEST(RegionDecision, EverySetSolvesTheSystemAndThereIsOne) {
  std::mt19937 random(3);
  for (int trial = 0; trial < 2000; ++trial) {
    const auto rates = random_rates(2 + trial % 5, random);
    const auto sets = admissible_region_sets(rates, 0.0);
    ASSERT_FALSE(sets.empty()) << "a variational inequality on a simplex has a solution";
    for (const auto& set : sets) expect_solves(rates, set);
  }
}

TEST(RegionDecision, OneSolutionThatAttractsWhereTheRatesAreMonotone) {
  std::mt19937 random(4);
  for (int trial = 0; trial < 500; ++trial) {
    const int n = 2 + trial % 5;
    const auto root = random_rates(n, random);
    RegionRates rates = root;
    const auto size = static_cast<std::size_t>(n);
    for (std::size_t i = 0; i < size; ++i) {
      for (std::size_t j = 0; j < size; ++j) {
        double& rate = rates.rates[i * size + j];
        rate = i == j ? 0.1 : 0.0;
        for (std::size_t k = 0; k < size; ++k) rate += root.rate(i, k) * root.rate(j, k);
      }
    }
    const auto sets = admissible_region_sets(rates, 0.0);
    ASSERT_EQ(sets.size(), 1U);
    EXPECT_TRUE(sets[0].attracts);
  }
}

TEST(RegionDecision, ColumnsMayBeShiftedAndRegionsRenumbered) {
  std::mt19937 random(5);
  for (int trial = 0; trial < 500; ++trial) {
    const auto rates = random_rates(3, random);
    RegionRates other = rates;  // regions in the order 2, 0, 1, and 5 more in a column
    const std::size_t order[3] = {2, 0, 1};
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j)
        other.rates[3 * i + j] = rates.rate(order[i], order[j]) + (j == 1 ? 5.0 : 0.0);
    }
    auto first = admissible_region_sets(rates, 0.0);
    auto second = admissible_region_sets(other, 0.0);
    ASSERT_EQ(first.size(), second.size());
    for (const auto& set : second) {
      std::vector<int> active;
      for (const int i : set.active) active.push_back(static_cast<int>(order[static_cast<std::size_t>(i)]));
      std::sort(active.begin(), active.end());
      const auto same = std::find_if(first.begin(), first.end(), [&](const auto& s) { return s.active == active; });
      ASSERT_NE(same, first.end());
      EXPECT_EQ(same->attracts, set.attracts);
    }
  }
}

TEST(RegionDecision, TwoRegionsSlideWhereBothFieldsLeadToTheOther) {
  // g1 = x, g2 = -x: region 1 is x < 0. Fields +1 and -1 meet, -1 and +1 part.
  const auto meet = admissible_region_sets({2, {1, -1, -1, 1}}, 0.0);
  ASSERT_EQ(meet.size(), 1U);
  EXPECT_EQ(meet[0].active, (std::vector<int>{0, 1}));
  EXPECT_NEAR(meet[0].weights[0], 0.5, 1e-15);
  const auto part = admissible_region_sets({2, {-1, 1, 1, -1}}, 0.0);
  ASSERT_EQ(part.size(), 3U);
  EXPECT_TRUE(part[preferred_region_set(part, {})].attracts);
  EXPECT_EQ(part[preferred_region_set(part, {1})].active, (std::vector<int>{1}));
}

TEST(RegionDecision, AnEquilibriumOfOneFieldIsOneMotionOfAllThatMeet) {
  const auto set = [](std::vector<int> active, std::vector<double> weights, bool marginal) {
    RegionSet made;
    made.active = std::move(active);
    made.weights = std::move(weights);
    made.marginal = marginal;
    return made;
  };
  std::vector<RegionSet> sets{set({1}, {1}, true), set({2}, {1}, false), set({1, 2}, {1, 0}, true),
                              set({0, 1, 2}, {0, 1, 0}, true), set({0, 2}, {0.5, 0.5}, true)};
  merge_same_motions(sets);
  ASSERT_EQ(sets.size(), 3U);
  EXPECT_EQ(sets[0].active, (std::vector<int>{2}));
  EXPECT_EQ(sets[1].active, (std::vector<int>{0, 1, 2}));
  EXPECT_EQ(sets[2].active, (std::vector<int>{0, 2}));
}

}  // namespace
}  // namespace saltus::switching
