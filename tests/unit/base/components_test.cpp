#include "saltus/base/components.hpp"

#include <random>

#include <gtest/gtest.h>

namespace saltus {
namespace {

using Lists = std::vector<std::vector<std::size_t>>;

TEST(Components, AreListedByTheirSmallestMember) {
  Components components(6);
  EXPECT_EQ(components.lists(), (Lists{{0}, {1}, {2}, {3}, {4}, {5}}));
  components.join(5, 1);
  components.join(4, 2);
  components.join(2, 5);
  EXPECT_EQ(components.lists(), (Lists{{0}, {1, 2, 4, 5}, {3}}));
  EXPECT_EQ(components.first(5), 1u);
}

TEST(Components, NothingHasNone) { EXPECT_TRUE(Components(0).lists().empty()); }

TEST(Components, AreThoseOfTheTransitiveClosure) {
  std::mt19937 random(20261125);
  for (int round = 0; round < 200; ++round) {
    const std::size_t n = 1 + random() % 12, edges = random() % 12;
    Components components(n);
    std::vector<std::vector<bool>> reaches(n, std::vector<bool>(n));
    for (std::size_t k = 0; k < n; ++k) reaches[k][k] = true;
    for (std::size_t e = 0; e < edges; ++e) {
      const std::size_t a = random() % n, b = random() % n;
      components.join(a, b);
      reaches[a][b] = reaches[b][a] = true;
    }
    for (std::size_t k = 0; k < n; ++k) {
      for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = 0; j < n; ++j) reaches[i][j] = reaches[i][j] || (reaches[i][k] && reaches[k][j]);
      }
    }
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j < n; ++j) EXPECT_EQ(components.first(i) == components.first(j), reaches[i][j]) << round;
    }
  }
}

TEST(Components, OfMembersAscendByTheirFirstOnes) {
  const auto found = components_of({7, 2, 9, 4, 3}, [](int a, int b) { return a + b == 11 || a + b == 6; });
  EXPECT_EQ(found, (std::vector<std::vector<int>>{{2, 4, 7, 9}, {3}}));
}

}  // namespace
}  // namespace saltus
